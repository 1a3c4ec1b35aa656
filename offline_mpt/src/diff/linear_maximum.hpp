#pragma once

#include <vector>

#include "exact_kkt/exact_region.hpp"

namespace polyfly {

struct LinearMaximum {
  Rational value;
  std::vector<Rational> t;
};

/// The greatest value of an affine function (p coefficients and a constant) where the rows are >= 0 in the box
/// |t_j| <= 1, without rounding. The set must not be empty.
LinearMaximum maximise(const std::vector<const ExactRow*>& rows, const std::vector<Rational>& function);

/// A number that direction . t (p numbers) does not exceed on the same set, in floating point: mostly near the maximum,
/// never below it. Of the direction 0 it is negative only if the set is empty.
double upperBound(const std::vector<const ExactRow*>& rows, const std::vector<double>& direction);

}  // namespace polyfly
