#pragma once

#include <vector>

#include "polytope_sets/exact_polytope.hpp"

namespace polyfly {

class RegionMap;

/// A double above the value, or 0 for 0.
double roundedUp(const Rational& value);

/// Greatest violation of a . theta <= b over vertices, 0 if there is none, and where.
Rational worst(const std::vector<std::vector<Integer>>& vertices, const RationalVector& a, const Rational& b,
               const std::vector<Integer>** where);

/// Mean of vertices; there is at least one.
RationalVector middleOf(const std::vector<std::vector<Integer>>& corners);

/// A set's rows, equalities as two, as distances where half ranges of the map's parameters are 1: the length
/// is rounded, the half-space is not.
std::vector<ExactHalfSpace> scaledRows(const ExactPolytope& set, const RegionMap& map);

}  // namespace polyfly
