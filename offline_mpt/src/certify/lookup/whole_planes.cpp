#include "certify/lookup/whole_planes.hpp"

#include <algorithm>

#include "arithmetic/exact_numbers.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

constexpr int kPrecisionBits = 53;    // rounding of one operation in binary64, relative
constexpr int kUnderflowBits = 1000;  // more than what operations lose below the least double
constexpr long kLeastBits = 120;      // the unit is 2^-120 or less, so that tolerances keep their digits

Rational powerOfTwo(long exponent) {
  Rational result(1);
  if (exponent >= 0) mpq_mul_2exp(result.get_mpq_t(), result.get_mpq_t(), static_cast<mp_bitcnt_t>(exponent));
  if (exponent < 0) mpq_div_2exp(result.get_mpq_t(), result.get_mpq_t(), static_cast<mp_bitcnt_t>(-exponent));
  return result;
}

Integer roundedUp(const Rational& value) {
  Integer result;
  mpz_cdiv_q(result.get_mpz_t(), value.get_num_mpz_t(), value.get_den_mpz_t());
  return result;
}

}  // namespace

WholePlanes::WholePlanes(const RegionMap& map, const ExactProgram& program)
    : p_(program.p), exponent_(kLeastBits) {
  std::vector<Rational> values;
  values.reserve(map.planeCount() * static_cast<std::size_t>(p_ + 1));
  Rational greatest;
  long least = kNoBit;
  for (std::size_t k = 0; k < map.planeCount(); ++k) {
    const double* const plane = map.plane(k);
    Rational constant(plane[p_]), size = abs(constant);
    for (int j = 0; j < p_; ++j) {
      const Rational entry(plane[j]);
      values.push_back(-entry * program.half[j]);
      constant -= entry * program.centre[j];
      size += abs(entry) * (abs(program.centre[j]) + program.half[j] * (1 + powerOfTwo(-int{kWideBits})));
    }
    values.push_back(constant);
    greatest = std::max(greatest, size);
  }
  for (const Rational& value : values) include(least, value);
  if (least != kNoBit) exponent_ = std::max(exponent_, -least);
  for (const Rational& value : values) planes_.push_back(scaled(value, exponent_));
  tolerance_ = up(Rational(map.tolerance()));
  const Rational rounding = (p_ + 3) * greatest * powerOfTwo(-kPrecisionBits) + powerOfTwo(-kUnderflowBits);
  rounding_ = roundedUp(rounding * powerOfTwo(kLeastBits))
              << static_cast<unsigned long>(exponent_ - kLeastBits);
}

WholeRow WholePlanes::row(std::int32_t signed_row) const {
  const auto first = planes_.begin() + (std::abs(signed_row) - 1) * static_cast<std::ptrdiff_t>(p_ + 1);
  WholeRow result(first, first + p_ + 1);
  if (signed_row < 0) {
    for (Integer& value : result) value = -value;
  }
  return result;
}

ExactRow WholePlanes::moved(std::int32_t signed_row, const Integer& distance) const {
  ExactRow result;
  result.value = row(signed_row);
  result.value.back() += distance;
  finishRow(result);
  return result;
}

Integer WholePlanes::up(const Rational& length) const { return roundedUp(length * powerOfTwo(exponent_)); }

Rational WholePlanes::length(const Integer& whole) const { return whole * powerOfTwo(-exponent_); }

Integer WholePlanes::leastInWideBox(const WholeRow& row) const {
  Integer sides(0);
  for (int j = 0; j < p_; ++j) sides += abs(row[static_cast<std::size_t>(j)]);
  return ((row.back() - sides) << kWideBits) - sides;
}

}  // namespace polyfly
