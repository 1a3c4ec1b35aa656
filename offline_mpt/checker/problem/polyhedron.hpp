#pragma once

#include <optional>
#include <vector>

#include "../dual_simplex.hpp"
#include "core/program.hpp"

/// Half-spaces in fractions. An exact simplex method finds multipliers; what counts is that they are checked.
namespace checker {

/// a . x <= bound
struct ExactHalfSpace {
  Vector a;
  Fraction bound;
};

/// v M
Vector timesMatrix(const Vector& v, const Matrix& M);

/// Weights whose sum of rows is the target. None where none are found; others are possible where rows depend on each other.
std::optional<Vector> weightsOf(const std::vector<Vector>& rows, const Vector& target);

/// The set where all of some rows hold, at least one.
class Polyhedron {
 public:
  explicit Polyhedron(std::vector<ExactHalfSpace> rows);

  /// An upper bound of a . x in the set: that of multipliers >= 0 whose sum of rows is a. None where none are found. A
  /// simplex method in doubles finds the rows; where their exact multipliers are not such, an exact one does.
  std::optional<Fraction> greatest(const Vector& a) const;
  /// Whether the half-space holds in all of the set, by the same.
  bool isWithin(const ExactHalfSpace& target) const;
  /// Whether no x meets all rows: multipliers >= 0 contradict.
  bool isEmpty() const;
  /// Whether some x meets all rows: one that is found and substituted.
  bool hasPoint() const;

  const std::vector<ExactHalfSpace>& rows() const { return rows_; }

 private:
  std::optional<Fraction> boundBy(const std::vector<std::size_t>& places, const Vector& a) const;
  std::optional<Fraction> quickly(const Vector& a) const;
  bool solve(const Vector& a) const;

  std::vector<ExactHalfSpace> rows_;
  mutable DualSimplex<double> quick_;
  mutable DualSimplex<Fraction> exact_;
};

/// What the other entries of x must meet so that entry `place` can be chosen: each upper bound of it with each lower one.
/// The entry stays, with factor 0.
std::vector<ExactHalfSpace> withoutEntry(const std::vector<ExactHalfSpace>& rows, std::size_t place);

/// The same set by fewer rows: without those that hold where the others do.
std::vector<ExactHalfSpace> withoutImplied(std::vector<ExactHalfSpace> rows);

}  // namespace checker
