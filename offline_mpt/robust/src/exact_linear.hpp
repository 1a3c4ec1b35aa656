#pragma once

#include <optional>
#include <vector>

#include "polytope_sets/rational.hpp"

namespace polyfly {

/// x = numerators / denominator, denominator > 0.
struct CommonFraction {
  std::vector<Integer> numerators;
  Integer denominator;
};

/// The solution of a system of linear equations. Unknowns that no row determines are 0.
struct IntegerSolution {
  CommonFraction x;
  /// Every row holds.
  bool consistent = true;
  /// Every unknown is determined.
  bool unique = true;
};

/// Solves a system by fraction-free (Bareiss) elimination. A row is the coefficients, then the right-hand side. A row
/// that contradicts others is ignored, and the solution is not consistent.
IntegerSolution solveIntegers(std::vector<std::vector<Integer>> rows, int unknowns);

}  // namespace polyfly
