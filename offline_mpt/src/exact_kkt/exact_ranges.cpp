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

std::vector<Rational> ExactRanges::inBox(const double* entries, double constant, int sign) const {
  std::vector<Rational> result;
  Rational rest(constant);
  for (std::size_t j = 0; j < half.size(); ++j) {
    const Rational entry(entries[j]);
    result.push_back(sign * entry * half[j]);
    rest += entry * centre[j];
  }
  result.push_back(sign * rest);
  return result;
}

Eigen::VectorXd ExactRanges::theta(const std::vector<Rational>& t) const {
  Eigen::VectorXd result(static_cast<Eigen::Index>(t.size()));
  for (std::size_t j = 0; j < t.size(); ++j)
    result(static_cast<Eigen::Index>(j)) = Rational(centre[j] + half[j] * t[j]).get_d();
  return result;
}

Rational ExactRanges::roundingOf(const double* entries, const Rational& reach) const {
  const std::size_t p = half.size();
  Rational size = abs(Rational(entries[p]));
  for (std::size_t j = 0; j < p; ++j) size += abs(Rational(entries[j])) * (abs(centre[j]) + half[j] * reach);
  return (p + 3) * size / Rational(Integer(1) << kPrecisionBits) +
         Rational(1) / Rational(Integer(1) << kUnderflowBits);
}

}  // namespace polyfly
