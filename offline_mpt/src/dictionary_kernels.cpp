#include "dictionary_kernels.hpp"

#include <algorithm>
#include <limits>

// The choice at start comes before the sanitizers are ready.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !defined(__clang__)
#define POLYFLY_FOR_EACH_PROCESSOR __attribute__((target_clones("avx2", "default")))
#else
#define POLYFLY_FOR_EACH_PROCESSOR
#endif

namespace polyfly {
namespace {

using Lanes =
    double __attribute__((vector_size(kLanes * sizeof(double)), aligned(alignof(double)), may_alias));

inline const Lanes& lanes(const double* numbers) { return *reinterpret_cast<const Lanes*>(numbers); }
inline Lanes& lanes(double* numbers) { return *reinterpret_cast<Lanes*>(numbers); }

}  // namespace

POLYFLY_FOR_EACH_PROCESSOR
void pivotColumns(double* columns, std::size_t stride, std::size_t count, std::size_t width,
                  const double* replacement, std::size_t j) {
  double* const pivot = columns + j * stride;
  for (std::size_t k = 0; k < width; ++k) {
    if (k == j) continue;
    double* const column = columns + k * stride;
    const double factor = replacement[k];
    for (std::size_t i = 0; i < count; i += kLanes) lanes(column + i) += lanes(pivot + i) * factor;
  }
  for (std::size_t i = 0; i < count; i += kLanes) lanes(pivot + i) *= replacement[j];
}

POLYFLY_FOR_EACH_PROCESSOR
double leastRatio(const double* value, const double* coefficient, double sign, double threshold,
                  std::size_t except, std::size_t count, double* quotient) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Lanes infinite = {kInfinity, kInfinity, kInfinity, kInfinity};
  const Lanes zero = {};
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Lanes c = lanes(coefficient + i) * sign;
    const Lanes v = lanes(value + i) > zero ? lanes(value + i) : zero;
    lanes(quotient + i) = c > threshold ? v / c : infinite;
  }
  if (except < count) quotient[except] = kInfinity;
  Lanes least = infinite;
  for (std::size_t i = 0; i < count; i += kLanes) {
    least = lanes(quotient + i) < least ? lanes(quotient + i) : least;
  }
  return std::min({least[0], least[1], least[2], least[3]});
}

POLYFLY_FOR_EACH_PROCESSOR
void leastOfColumns(const double* columns, std::size_t stride, std::size_t count, std::size_t width,
                    double* out) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    Lanes least = lanes(columns + i);
    for (std::size_t k = 1; k < width; ++k) {
      const Lanes& next = lanes(columns + k * stride + i);
      least = next < least ? next : least;
    }
    lanes(out + i) = least;
  }
}

}  // namespace polyfly
