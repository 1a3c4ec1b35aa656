#pragma once

#include <cstddef>
#include <vector>

#include "lp/dictionary_kernels.hpp"

namespace polyfly {

/// Sides of a plane, to be added.
constexpr unsigned kBelow = 1;
constexpr unsigned kAbove = 2;

/// The inner loops of tree building for one number of parameters. A plane is p + 1 numbers (a, c).
struct PlaneSides {
  /// a . t - c
  double (*distance)(const double* plane, const double* point, std::size_t p);

  /// Sides further than `tolerance` from the plane on which one of `count` points lies, added to `sides`; the
  /// search ends as soon as these are the `possible` ones.
  unsigned (*of_points)(const double* plane, const double* points, std::size_t count, double tolerance,
                        unsigned possible, unsigned sides, std::size_t p);
};

/// Unrolled for p up to 8.
PlaneSides planeSidesFor(std::size_t p);

/// Some planes, to be compared with many points at once. The numbers of one coefficient lie side by side, for the
/// processor's sake.
class PlaneBlock {
 public:
  /// `planes` as in TreeRegions, `chosen` indices of them.
  PlaneBlock(const std::vector<double>& planes, const std::vector<std::size_t>& chosen, std::size_t p);

  /// Adds `weight` to the sides of each plane, further than `tolerance`, on which `point` or one of the others lies.
  void weigh(const double* point, PointList others, double tolerance, double weight);
  /// What was added below and above chosen plane i.
  double below(std::size_t i) const { return below_[i]; }
  double above(std::size_t i) const { return above_[i]; }

 private:
  std::size_t p_;
  std::size_t padded_;  // number of planes, rounded up
  std::vector<double> coefficients_;
  std::vector<double> below_, above_;
};

}  // namespace polyfly
