#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "core/map.hpp"

/// Half-spaces in whole numbers, and what both kinds of certificates say of them.
namespace checker {

using Integer = mpz_class;
using Fraction = mpq_class;
using Vector = std::vector<Fraction>;
using Row = std::vector<Integer>;  // row (t, 1) >= 0
using Weights = std::vector<std::pair<std::size_t, Integer>>;

constexpr std::size_t kMany = 100000000;  // more than any list of a certificate has
/// Rows of a cell that covers divide. It bounds how deeply covers are nested, and so the stack.
constexpr std::size_t kMostCellRows = 2000;

/// The greatest tolerances that a certificate may state: with any, anything could be confirmed.
constexpr double kMostLawTolerance = 1e-6;    ///< of the greatest |u| of a law in the box
constexpr double kMostPlaneTolerance = 1e-7;  ///< [scaled]

/// The same half-space in whole numbers without a common factor.
Row primitive(const Vector& values);
Row primitive(const Row& values);

/// The other side of a half-space.
Row negated(const Row& row);

/// With any sign. Refuses a row b of zeros, as sameHalfSpace does.
bool proportional(const Row& a, const Row& b);
bool sameHalfSpace(const Row& a, const Row& b);
Integer leastInBox(const Row& row);

/// Number of bits of the greatest entry.
int bitsOf(const Row& row);

/// row (t, 1)
template <class Numbers>
Fraction valueAt(const Numbers& row, const Vector& t) {
  Fraction value(row.back());
  for (std::size_t j = 0; j < t.size(); ++j) value += row[j] * t[j];
  return value;
}

template <class List, class Value>
bool contains(const List& list, const Value& value) {
  return std::find(std::begin(list), std::end(list), value) != std::end(list);
}

/// scale * target - sum of weight * row, rows in unit form: shifted to the same number of bits.
Row remainder(const Row* target, const Integer& scale, const Weights& weights,
              const std::vector<const Row*>& rows);

Weights readWeights(Line& line);

/// Reads a proof that no point of the box has all rows > 0, on the plane if one is given.
void requireEmpty(Line& line, const std::vector<const Row*>& rows, const Row* plane);

/// theta = centre + half .* t, of a map's box.
struct Scaling {
  explicit Scaling(const Map& map);
  /// sign * entries . theta + constant as a row in t, with p entries.
  template <class Number>
  Vector inBox(const Number* entries, int sign, const Fraction& constant) const {
    Vector result;
    Fraction sum = constant;
    for (std::size_t j = 0; j < half.size(); ++j) {
      const Fraction entry = sign * Fraction(entries[j]);
      result.push_back(entry * half[j]);
      sum += entry * centre[j];
    }
    result.push_back(sum);
    return result;
  }
  /// Greatest |u| in the box of a row of a law: p entries, then its constant.
  Fraction greatestInBox(const double* law_row) const {
    Fraction sum;
    for (const Fraction& entry : inBox(law_row, 1, Fraction(law_row[half.size()]))) sum += abs(entry);
    return sum;
  }
  /// The inner side of a signed row of the map: row (t, 1) >= 0.
  Vector mapRow(const Map& map, std::int32_t row) const;
  /// Greatest error of entries[0..p) . theta + entries[p] in binary64 where |t_j| <= reach: in any order, with or without
  /// fused operations.
  Fraction roundingOf(const double* entries, const Fraction& reach) const;

  Vector centre, half;
};

}  // namespace checker
