#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "mpc_core/identity_form.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// Describes active sets of a strictly convex program without equalities in numbers of 32 digits, from its
/// identity form: slack = D (t, 1) + rows w, u = law (t, 1) - output w, w = sum_active row' lambda.
///
/// One object, one thread.
class DoubleDoubleRegionSolver {
 public:
  explicit DoubleDoubleRegionSolver(const NormalisedProgram& reduced);

  /// False where it may mislead: the rows depend on each other too nearly, or the program is another kind.
  bool solve(const std::vector<std::uint16_t>& active);

  // Of the set that was described last, in the units of NormalisedProgram; affine functions of t are p + 1
  // numbers, constant last.

  /// Of active row `place`, in the order given.
  void multiplier(std::size_t place, double* affine) const;
  /// Of row `row` of the reduced program.
  void slack(int row, double* affine) const;
  /// q rows
  void law(std::vector<double>& out) const;

 private:
  Eigen::Index n_;
  // None where it may mislead.
  std::optional<IdentityForm> form_;
  WideMatrix rows_;         // unit rows, m x n
  WideMatrix bounds_;       // D, m x (p + 1)
  WideMatrix multipliers_;  // k x (p + 1)
  WideMatrix point_;        // w, n x (p + 1)
};

}  // namespace polyfly
