#include "arithmetic/exact_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace polyfly {
namespace {

/// The power of two in a number that is a whole multiple of it, and of no greater one.
long lowestBit(const Rational& value) {
  return static_cast<long>(mpz_scan1(value.get_num_mpz_t(), 0)) -
         static_cast<long>(mpz_sizeinbase(value.get_den_mpz_t(), 2)) + 1;
}

}  // namespace

void include(long& least, const Rational& value) {
  if (value != 0) least = std::min(least, lowestBit(value));
}

double above(const Rational& value) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double result = value.get_d();
  while (std::isfinite(result) && Rational(result) < value) result = std::nextafter(result, kInfinity);
  return result == -kInfinity ? std::numeric_limits<double>::lowest() : result;
}

Rational timesPowerOfTwo(Rational value, long exponent) {
  const auto multiply = exponent >= 0 ? mpq_mul_2exp : mpq_div_2exp;
  multiply(value.get_mpq_t(), value.get_mpq_t(), static_cast<mp_bitcnt_t>(std::abs(exponent)));
  return value;
}

Integer commonDenominator(const std::vector<Rational>& values) {
  Integer denominator(1);
  for (const Rational& value : values) denominator = lcm(denominator, value.get_den());
  return denominator;
}

Integer scaled(const Rational& value, long exponent) { return timesPowerOfTwo(value, exponent).get_num(); }

IntegerMatrix wholeRows(const std::vector<Rational>& values, int columns) {
  const int rows = static_cast<int>(values.size()) / columns;
  IntegerMatrix result(rows, columns);
  for (int i = 0; i < rows; ++i) {
    long least = kNoBit;
    for (int j = 0; j < columns; ++j) include(least, values[i * columns + j]);
    for (int j = 0; j < columns && least != kNoBit; ++j)
      result(i, j) = scaled(values[i * columns + j], -least);
  }
  return result;
}

}  // namespace polyfly
