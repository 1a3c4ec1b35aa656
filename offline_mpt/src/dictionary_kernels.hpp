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

/// quotient[i] = max(value[i], 0) / c with c = sign * coefficient[i], where c > threshold; infinite elsewhere
/// and at `except` (count: nowhere). Returns the least of them.
double leastRatio(const double* value, const double* coefficient, double sign, double threshold,
                  std::size_t except, std::size_t count, double* quotient);

/// out[i] = the least of `width` columns at i.
void leastOfColumns(const double* columns, std::size_t stride, std::size_t count, std::size_t width,
                    double* out);

}  // namespace polyfly
