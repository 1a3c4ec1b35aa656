#pragma once

#include <gmpxx.h>

#include <cstddef>
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
Fraction valueAt(const Row& row, const Vector& t);

/// scale * target - sum of weight * row, rows in unit form: shifted to the same number of bits.
Row remainder(const Row* target, const Integer& scale, const Weights& weights,
              const std::vector<const Row*>& rows);

Weights readWeights(Line& line);

/// Reads a proof that no point of the box has all rows > 0, on the plane if one is given.
void requireEmpty(Line& line, const std::vector<const Row*>& rows, const Row* plane);

/// theta = centre + half .* t, of a map's box.
struct Scaling {
  explicit Scaling(const Map& map);
  /// sign * entries . theta + constant as a row in t.
  Vector inBox(const double* entries, int sign, const Fraction& constant) const;
  /// Greatest error of entries[0..p) . theta + entries[p] in binary64 where |t_j| <= reach: in any order, with or without
  /// fused operations.
  Fraction roundingOf(const double* entries, const Fraction& reach) const;

  Vector centre, half;
};

}  // namespace checker
