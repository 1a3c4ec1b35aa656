#pragma once

#include <utility>
#include <vector>

#include "arithmetic/exact_matrix.hpp"

namespace polyfly {

/// max c . x over a . x <= b and |x_j| <= 1, without rounding.
struct BoxMaximum {
  bool exists = false;
  std::vector<Rational> x;  ///< where it exists
  Rational objective;
  /// Rows with their weights > 0. With sides of the box they combine to c . x <= objective, or where no x exists to
  /// 0 . x <= negative.
  std::vector<std::pair<int, Rational>> weights;
};

/// Each row is (a, b), as many numbers as c has and one more. `basis` names rows that may be tight at the maximum, as
/// FloatLp does: where they prove it, nothing else is computed.
BoxMaximum maximiseInBox(const std::vector<std::vector<Integer>>& rows, const std::vector<Integer>& c,
                         const std::vector<int>& basis);

}  // namespace polyfly
