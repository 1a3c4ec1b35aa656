#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "certify/farkas_proof.hpp"
#include "exact_kkt/exact_ranges.hpp"

namespace polyfly {

class RegionMap;

/// An affine function of t as p + 1 whole numbers, the constant last.
using WholeRow = std::vector<Integer>;

/// The planes of a map in t, all multiplied by one power of two so that no number has a fraction. Lengths below, such
/// as the tolerance, are whole numbers in the same unit.
class WholePlanes {
 public:
  WholePlanes(const RegionMap& map, const ExactRanges& ranges);

  /// Why look-ups compute too roughly for a proof; empty where they do not.
  const std::string& tooRough() const { return too_rough_; }

  /// A signed row as in MapContent::rows: row (t, 1) >= 0 on its inner side.
  WholeRow row(std::int32_t signed_row) const;
  /// The same moved outwards by `distance`, or inwards where that is negative.
  ExactRow moved(std::int32_t signed_row, const Integer& distance) const;

  /// `length` in the unit of the rows, rounded up.
  Integer up(const Rational& length) const;
  /// `whole` rounded down to a multiple of 2^-120 as a length.
  Integer coarselyDown(const Rational& whole) const;
  Rational length(const Integer& whole) const;

  const Integer& tolerance() const { return tolerance_; }
  /// Greatest rounding error of the distance from any plane that a look-up computes in binary64.
  const Integer& rounding() const { return rounding_; }
  int parameters() const { return p_; }

  /// Least value of the row where |t_j| <= 1 + 2^-kWideBits, multiplied by 2^kWideBits. Look-ups accept no more than
  /// that.
  Integer leastInWideBox(const WholeRow& row) const;
  static constexpr unsigned kWideBits = 26;

 private:
  int p_;
  long exponent_;
  std::vector<Integer> planes_;
  Integer tolerance_, rounding_;
  std::string too_rough_;
};

}  // namespace polyfly
