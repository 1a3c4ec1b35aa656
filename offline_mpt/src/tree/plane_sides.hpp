#pragma once

#include <cstddef>

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

}  // namespace polyfly
