#include "certify/lookup/whole_planes.hpp"

#include <algorithm>

#include "arithmetic/exact_numbers.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

constexpr unsigned long kBoundBits = 50;  // a look-up's bounds of the box are off by 2^-50 of their size
constexpr long kLeastBits = 120;          // the unit is 2^-120 or less, so that tolerances keep their digits

Rational powerOfTwo(long exponent) { return timesPowerOfTwo(1, exponent); }

Integer roundedUp(const Rational& value) {
  Integer result;
  mpz_cdiv_q(result.get_mpz_t(), value.get_num_mpz_t(), value.get_den_mpz_t());
  return result;
}

}  // namespace

WholePlanes::WholePlanes(const RegionMap& map, const ExactRanges& ranges)
    : p_(static_cast<int>(ranges.half.size())), exponent_(kLeastBits) {
  const std::vector<Rational>&centre = ranges.centre, &half = ranges.half;
  const Rational reach = 1 + powerOfTwo(-int{kWideBits});
  std::vector<Rational> values;
  values.reserve(map.planeCount() * static_cast<std::size_t>(p_ + 1));
  Rational rounding;
  long least = kNoBit;
  for (std::size_t k = 0; k < map.planeCount(); ++k) {
    const double* const plane = map.plane(k);
    for (Rational& value : ranges.inside(plane)) values.push_back(std::move(value));
    rounding = std::max(rounding, ranges.roundingOf(plane, reach));
  }
  for (const Rational& value : values) include(least, value);
  if (least != kNoBit) exponent_ = std::max(exponent_, -least);
  for (const Rational& value : values) planes_.push_back(scaled(value, exponent_));
  tolerance_ = up(Rational(map.tolerance()));
  rounding_ = roundedUp(rounding * powerOfTwo(kLeastBits))
              << static_cast<unsigned long>(exponent_ - kLeastBits);
  if (4 * rounding_ > tolerance_)
    too_rough_ =
        "distances from planes are not computed precisely enough: the rounding of a look-up may exceed a "
        "quarter of the map's tolerance";
  const Rational wide = powerOfTwo(-int{kWideBits}) - Rational(map.tolerance());
  for (std::size_t j = 0; j < half.size() && too_rough_.empty(); ++j) {
    if ((abs(centre[j]) + half[j]) / (Integer(1) << kBoundBits) > wide * half[j])
      too_rough_ = "the range of " + map.parameters()[j].name + " is too narrow for the size of its numbers";
  }
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

Integer WholePlanes::coarselyDown(const Rational& whole) const {
  const Integer unit = Integer(1) << static_cast<unsigned long>(exponent_ - kLeastBits);
  const Rational units = whole / unit;
  Integer result;
  mpz_fdiv_q(result.get_mpz_t(), units.get_num_mpz_t(), units.get_den_mpz_t());
  return result * unit;
}

Rational WholePlanes::length(const Integer& whole) const { return whole * powerOfTwo(-exponent_); }

Integer WholePlanes::leastInWideBox(const WholeRow& row) const {
  Integer sides(0);
  for (int j = 0; j < p_; ++j) sides += abs(row[static_cast<std::size_t>(j)]);
  return ((row.back() - sides) << kWideBits) - sides;
}

}  // namespace polyfly
