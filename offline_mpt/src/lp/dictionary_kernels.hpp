#pragma once

#include <cstddef>

namespace polyfly {

/// The inner loops of `Dictionary`, over columns of numbers that stand side by side. Compiled for the
/// processor's wider registers too, chosen when the program starts; no sum is reordered, so the numbers are
/// the same on all. Lengths are multiples of kLanes.
constexpr std::size_t kLanes = 4;

constexpr std::size_t padded(std::size_t count) { return (count + kLanes - 1) / kLanes * kLanes; }

/// Of `width` columns, `stride` apart: column k += column j * replacement[k] for k != j, column j *=
/// replacement[j].
void pivotColumns(double* columns, std::size_t stride, std::size_t count, std::size_t width,
                  const double* replacement, std::size_t j);

/// What stops a column first: how far it goes (infinite: nothing stops it), and the place that does (-1:
/// none).
struct Blocking {
  double step;
  int place;
};

/// quotient[i] = max(value[i], 0) / c with c = sign * coefficient[i], where c > threshold; infinite elsewhere
/// and at `except` (count: nowhere). The least of them stops; of those within `tie` of it, the place of the
/// greatest coefficient, the first of equals.
Blocking leastRatio(const double* value, const double* coefficient, double sign, double threshold, double tie,
                    std::size_t except, std::size_t count, double* quotient);

/// The places i < count at which all of `width` columns are at least `threshold`, ascending, into `places`;
/// how many.
std::size_t placesAbove(const double* columns, std::size_t stride, std::size_t count, std::size_t width,
                        double threshold, int* places);

/// Some points of p numbers each.
struct PointList {
  const double* numbers;
  std::size_t count;
};

/// Adds `weight` to below[i] where the distance a_i . t - c_i of plane i to one of the points is less than
/// -tolerance, and to above[i] where one is more than tolerance. `planes` are p columns of coefficients and one of c,
/// each of `stride` numbers, a multiple of kLanes.
void weighSides(const double* planes, std::size_t stride, std::size_t p, const double* point,
                PointList others, double tolerance, double weight, double* below, double* above);

}  // namespace polyfly
