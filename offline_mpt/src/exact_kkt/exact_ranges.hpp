#pragma once

#include <Eigen/Core>
#include <vector>

#include "arithmetic/exact_numbers.hpp"
#include "region_maps/signal.hpp"

namespace polyfly {

/// The box of parameters: theta = centre + half .* t, |t_j| <= 1.
struct ExactRanges {
  explicit ExactRanges(const std::vector<Signal>& parameters);

  /// sign * (entries[0..p) . theta + constant) as a function of t: p numbers, then its constant.
  std::vector<Rational> inBox(const double* entries, double constant, int sign = 1) const;
  /// The same of c - a . theta, with `plane` (a, c), or of its opposite.
  std::vector<Rational> inside(const double* plane, int sign = 1) const {
    return inBox(plane, -plane[half.size()], -sign);
  }

  /// The parameter of t, rounded.
  Eigen::VectorXd theta(const std::vector<Rational>& t) const;

  /// Greatest error of entries[0..p) . theta + entries[p] in binary64 where |t_j| <= reach: in any order, with or without
  /// fused operations.
  Rational roundingOf(const double* entries, const Rational& reach) const;

  std::vector<Rational> centre;
  std::vector<Rational> half;
};

}  // namespace polyfly
