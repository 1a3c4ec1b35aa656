#include "lp/dictionary_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

// The choice at start comes before the sanitizers are ready.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__clang__)
#define POLYFLY_FOR_EACH_PROCESSOR __attribute__((target_clones("avx2", "default")))
#else
#define POLYFLY_FOR_EACH_PROCESSOR
#endif

namespace polyfly {
namespace {

// Sums and comparisons of lanes stand in the kernels themselves: a function of its own would be compiled for
// the narrowest processor, even where it ends up inside a kernel for a wider one.
using Lanes =
    double __attribute__((vector_size(kLanes * sizeof(double)), aligned(alignof(double)), may_alias));
using Marks = decltype(Lanes{} < Lanes{});

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Lanes kInfinite = {kInfinity, kInfinity, kInfinity, kInfinity};

inline const Lanes& lanes(const double* numbers) { return *reinterpret_cast<const Lanes*>(numbers); }
inline Lanes& lanes(double* numbers) { return *reinterpret_cast<Lanes*>(numbers); }

/// Bit k: lane k is marked.
inline unsigned bits(const Marks& marks) {
#if defined(__SSE2__)
  const auto half = [&](int k) {
    return static_cast<unsigned>(_mm_movemask_pd(_mm_castsi128_pd(_mm_set_epi64x(marks[k + 1], marks[k]))));
  };
  return half(0) | half(2) << 2U;
#else
  unsigned found = 0;
  for (unsigned k = 0; k < kLanes; ++k) found |= marks[k] != 0 ? 1U << k : 0U;
  return found;
#endif
}

/// The lanes marked in `bits` from `first` on, one after the other: act(place).
template <typename Act>
inline void forEachMarked(unsigned bits, std::size_t first, const Act& act) {
  for (; bits != 0; bits &= bits - 1) act(first + static_cast<std::size_t>(__builtin_ctz(bits)));
}

}  // namespace

POLYFLY_FOR_EACH_PROCESSOR
void pivotColumns(double* columns, std::size_t stride, std::size_t count, std::size_t width,
                  const double* replacement, std::size_t j) {
  double* const pivot = columns + j * stride;
  const auto next = [j](std::size_t k) { return k + 1 == j ? k + 2 : k + 1; };
  std::size_t k = j == 0 ? 1 : 0;
  while (k < width) {
    double* const column = columns + k * stride;
    const double factor = replacement[k];
    const std::size_t second = next(k);
    if (second < width) {  // two at a time: the pivot is read once
      double* const other = columns + second * stride;
      const double its_factor = replacement[second];
      for (std::size_t i = 0; i < count; i += kLanes) {
        const Lanes p = lanes(pivot + i);
        lanes(column + i) += p * factor;
        lanes(other + i) += p * its_factor;
      }
      k = next(second);
    } else {
      for (std::size_t i = 0; i < count; i += kLanes) lanes(column + i) += lanes(pivot + i) * factor;
      k = second;
    }
  }
  for (std::size_t i = 0; i < count; i += kLanes) lanes(pivot + i) *= replacement[j];
}

POLYFLY_FOR_EACH_PROCESSOR
Blocking leastRatio(const double* value, const double* coefficient, double sign, double threshold, double tie,
                    std::size_t except, std::size_t count, double* quotient) {
  const Lanes zero = {};
  Lanes least = kInfinite;
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Lanes c = lanes(coefficient + i) * sign;
    const Lanes v = lanes(value + i) > zero ? lanes(value + i) : zero;
    Lanes q = c > threshold ? v / c : kInfinite;
    if (except - i < kLanes) q[except - i] = kInfinity;
    lanes(quotient + i) = q;
    least = q < least ? q : least;
  }
  Blocking found{std::min({least[0], least[1], least[2], least[3]}), -1};
  if (found.step == kInfinity) return found;
  double greatest = 0.0;
  for (std::size_t i = 0; i < count; i += kLanes) {
    forEachMarked(bits(lanes(quotient + i) <= found.step + tie), i, [&](std::size_t place) {
      const double size = std::abs(coefficient[place]);
      if (size <= greatest) return;
      greatest = size;
      found.place = static_cast<int>(place);
    });
  }
  return found;
}

POLYFLY_FOR_EACH_PROCESSOR
std::size_t placesAbove(const double* columns, std::size_t stride, std::size_t count, std::size_t width,
                        double threshold, int* places) {
  std::size_t found = 0;
  const auto keep = [&](std::size_t place) { places[found++] = static_cast<int>(place); };
  std::size_t i = 0;
  for (; i + 2 * kLanes <= count; i += 2 * kLanes) {  // two chains of comparisons side by side
    Lanes left = lanes(columns + i), right = lanes(columns + i + kLanes);
    for (std::size_t k = 1; k < width; ++k) {
      const double* column = columns + k * stride + i;
      left = lanes(column) < left ? lanes(column) : left;
      right = lanes(column + kLanes) < right ? lanes(column + kLanes) : right;
    }
    forEachMarked(bits(left >= threshold), i, keep);
    forEachMarked(bits(right >= threshold), i + kLanes, keep);
  }
  if (i < count) {
    Lanes least = lanes(columns + i);
    for (std::size_t k = 1; k < width; ++k) {
      const Lanes& next = lanes(columns + k * stride + i);
      least = next < least ? next : least;
    }
    forEachMarked(bits(least >= threshold), i, keep);
  }
  return found;
}

POLYFLY_FOR_EACH_PROCESSOR
void weighSides(const double* planes, std::size_t stride, std::size_t p, const double* point,
                PointList others, double tolerance, double weight, double* below, double* above) {
  for (std::size_t i = 0; i < stride; i += kLanes) {
    Lanes low = -lanes(planes + p * stride + i);
    for (std::size_t j = 0; j < p; ++j) low += lanes(planes + j * stride + i) * point[j];
    Lanes high = low;
    for (std::size_t k = 0; k < others.count; ++k) {
      const double* const other = others.numbers + k * p;
      Lanes distance = -lanes(planes + p * stride + i);
      for (std::size_t j = 0; j < p; ++j) distance += lanes(planes + j * stride + i) * other[j];
      low = distance < low ? distance : low;
      high = distance > high ? distance : high;
    }
    lanes(below + i) += low < -tolerance ? Lanes{} + weight : Lanes{};
    lanes(above + i) += high > tolerance ? Lanes{} + weight : Lanes{};
  }
}

}  // namespace polyfly
