#pragma once

#include <vector>

#include "polytope_sets/exact_polytope.hpp"

namespace polyfly {

/// A polyhedron as the cone over {1} x set, its generators kept: a ray with value[0] > 0 is the vertex
/// value[1..] / value[0], one with 0 a ray of the set.
struct PolytopeCone {
  explicit PolytopeCone(const ExactPolytope& set);
  bool isEmpty() const;

  DoubleDescription cone;
  /// Place of each row of the set among the rows of the cone.
  std::vector<std::size_t> place;
};

/// Values of the rays.
std::vector<std::vector<Integer>> raysOf(const DoubleDescription& cone);

/// Throws Error naming `what` when the set does not have this many dimensions.
void requireDimension(const ExactPolytope& set, std::size_t dimension, const char* what);

}  // namespace polyfly
