#pragma once

#include <optional>
#include <vector>

#include "core/program.hpp"

/// Half-spaces in fractions. An exact simplex method finds multipliers; what counts is that they are checked.
namespace checker {

/// a . x <= bound
struct HalfSpace {
  Vector a;
  Fraction bound;
};

/// v M
Vector timesMatrix(const Vector& v, const Matrix& M);

/// An upper bound of a . x where all rows hold, by multipliers >= 0 whose sum of rows is a. None where none are found.
std::optional<Fraction> greatestOf(const Vector& a, const std::vector<HalfSpace>& rows);

/// Whether the half-space holds where all rows do, by such multipliers.
bool holdsWhere(const std::vector<HalfSpace>& rows, const HalfSpace& target);

/// Whether some x meets all rows: one that is found and substituted.
bool hasPoint(const std::vector<HalfSpace>& rows);

/// What the other entries of x must meet so that entry `place` can be chosen: each upper bound of it with each lower one.
/// The entry stays, with factor 0.
std::vector<HalfSpace> withoutEntry(const std::vector<HalfSpace>& rows, std::size_t place);

/// The same set by fewer rows: without those that hold where the others do.
std::vector<HalfSpace> withoutImplied(std::vector<HalfSpace> rows);

}  // namespace checker
