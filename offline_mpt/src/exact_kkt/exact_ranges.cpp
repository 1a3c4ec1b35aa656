#include "exact_kkt/exact_ranges.hpp"

#include <cstddef>

namespace polyfly {
namespace {

constexpr unsigned long kPrecisionBits = 53;    // rounding of one operation in binary64, relative
constexpr unsigned long kUnderflowBits = 1000;  // more than what operations lose below the least double

}  // namespace

ExactRanges::ExactRanges(const std::vector<Signal>& parameters) {
  for (const Signal& signal : parameters) {
    centre.push_back((Rational(signal.upper) + Rational(signal.lower)) / 2);
    half.push_back((Rational(signal.upper) - Rational(signal.lower)) / 2);
  }
}

Rational ExactRanges::roundingOf(const double* entries, const Rational& reach) const {
  const std::size_t p = half.size();
  Rational size = abs(Rational(entries[p]));
  for (std::size_t j = 0; j < p; ++j) size += abs(Rational(entries[j])) * (abs(centre[j]) + half[j] * reach);
  return (p + 3) * size / Rational(Integer(1) << kPrecisionBits) +
         Rational(1) / Rational(Integer(1) << kUnderflowBits);
}

}  // namespace polyfly
