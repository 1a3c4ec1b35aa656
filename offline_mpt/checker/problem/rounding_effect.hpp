#pragma once

#include <utility>
#include <vector>

#include "core/program.hpp"
#include "problem/optimal_control.hpp"

namespace checker {

using Ranges = std::vector<std::pair<double, double>>;

/// By how much the inputs of a program may differ from those of the expected one. With fixed rows, the optimum of a
/// strictly convex program moves, in the norm of H, by at most |dH z + dF (theta, 1)| in the norm of H^-1. A row that moves
/// takes it along by at most its own distance in that norm; of several rows, the furthest counts.
class RoundingEffect {
 public:
  /// `parameters` and `inputs` are ranges. The first `moves` entries of z are inputs, stage by stage, or what they add to a
  /// feedback. Throws Refused where H may be singular.
  RoundingEffect(const Matrices& program, const Ranges& parameters, const Ranges& inputs, std::size_t moves);

  /// Differences of H and F, which has f as its last column.
  void addCost(const ExpectedProgram& expected);
  /// Differences of one row, whose numbers are at least `on_z`, `on_theta` and `bound` apart.
  void addRow(const Vector& row, const Vector& on_z, const Vector& on_theta, const Fraction& bound);
  /// Differences of C and c, then the greatest of an input as a share of its range, without a range of its greatest value
  /// without bounds.
  Fraction ofInputs(const BallMatrix& C) const;

 private:
  Fraction lengthOf(const Vector& vector) const;
  void boundVariables();

  const Matrices& program_;
  const Ranges inputs_;
  std::size_t moves_, n_, p_;
  BallMatrix inverse_;
  /// Greatest |theta_j|, and 1.
  Vector theta_;
  /// Greatest |z_j|, by bounds of z_j alone, else of the unconstrained minimiser; what an input adds to a feedback is also
  /// counted with the input's whole range.
  Vector z_;
  /// Greatest |z_j| of the unconstrained minimiser.
  Vector free_;
  Fraction cost_, row_;
};

}  // namespace checker
