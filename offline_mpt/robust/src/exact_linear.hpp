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

/// A solution of the rows (coefficients, then right-hand side), by Bareiss' elimination in whole numbers.
/// Unknowns that no row determines are 0. `consistent` tells whether every row holds, `unique` whether every
/// unknown is determined; rows that contradict those before them are passed over.
struct IntegerSolution {
  CommonFraction x;
  bool consistent = true;
  bool unique = true;
};
IntegerSolution solveIntegers(std::vector<std::vector<Integer>> rows, int unknowns);

}  // namespace polyfly
