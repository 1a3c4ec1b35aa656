#pragma once

#include <vector>

#include "arithmetic/exact_numbers.hpp"
#include "region_maps/signal.hpp"

namespace polyfly {

/// The box of parameters: theta = centre + half .* t, |t_j| <= 1.
struct ExactRanges {
  explicit ExactRanges(const std::vector<Signal>& parameters);

  /// Greatest error of entries[0..p) . theta + entries[p] in binary64 where |t_j| <= reach: in any order, with or without
  /// fused operations.
  Rational roundingOf(const double* entries, const Rational& reach) const;

  std::vector<Rational> centre;
  std::vector<Rational> half;
};

}  // namespace polyfly
