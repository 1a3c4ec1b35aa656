#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "arithmetic/double_double.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// Describes active sets of a strictly convex program without equalities in numbers of 32 digits, from the
/// program as it was given. With H = L L' and unit rows m_i of A L^-T,
///
///     slack_i = s_i + m_i w,   u = offset - E L^-T w,   w = L^-1 cost + sum_active m_j' lambda_j.
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
  using Numbers = std::vector<DoubleDouble>;  // row-major

  bool factoriseHessian();
  void layCost(const Numbers& centre, const Numbers& half);
  void layRows(const Numbers& centre, const Numbers& half);
  void layOutputs(const Numbers& centre, const Numbers& half);
  bool factorise(const std::vector<std::uint16_t>& active);
  void solveFactor(const std::vector<std::uint16_t>& active);

  const NormalisedProgram& reduced_;
  std::size_t n_, width_;  // width: p + 1
  bool usable_ = false;
  // Approximate condition number of L.
  double root_condition_ = 1.0;
  Numbers root_;     // L, n x n
  Numbers free_;     // L^-1 cost, n x (p + 1)
  Numbers rows_;     // m_i, m x n
  Numbers bounds_;   // s_i, m x (p + 1)
  Numbers outputs_;  // E L^-T, q x n
  Numbers offsets_;  // q x (p + 1)
  // Cholesky factor of the active rows' gram matrix.
  Numbers factor_;       // k x k
  Numbers multipliers_;  // k x (p + 1)
  Numbers point_;        // w, n x (p + 1)
};

}  // namespace polyfly
