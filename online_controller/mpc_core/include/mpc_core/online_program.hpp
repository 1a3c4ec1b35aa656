#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "mpc_core/bounded_qp.hpp"
#include "mpc_core/parametric_program.hpp"
#include "mpc_core/scaled_program.hpp"

namespace polyfly {

/// A parametric program solved at one parameter after the other, as in flight. Rows with a single entry are bounds of
/// that variable, the others stay rows. It is solved in the units of scaleProgram. Where H is conditioned too badly for that, the program is solved in its identity
/// form (identity_form.hpp), and all rows stay rows. Each solution starts from the active set of the one before.
///
/// After construction nothing allocates, throws or reads a clock. One object serves one thread.
class OnlineProgram {
 public:
  /// H must be positive definite. Throws Error naming the program.
  explicit OnlineProgram(const ParametricProgram& program);

  /// Outputs u (program().inputCount() numbers) at theta. Unless kOptimal, u is left alone. `more`, a number for each
  /// variable, is added to the gradient f + F theta; nullptr: nothing.
  QpStatus solve(const double* theta, double* u, const double* more = nullptr) noexcept;

  /// Forgets the active set.
  void reset() noexcept { warm_ = false; }

  /// The minimiser of the last solution, program().variableCount() numbers.
  const double* z() const noexcept { return z_.data(); }

  const ParametricProgram& program() const noexcept { return program_; }
  const BoundedQp& solver() const noexcept { return qp_; }

 private:
  struct Bound {
    // Row of the program.
    int row = 0;
    int variable = 0;
    // 1 over the single entry of the row.
    double scale = 0.0;
  };

  /// The identity form, rounded.
  struct Transformed {
    Eigen::MatrixXd rows;          // m x n
    Eigen::MatrixXd slack;         // m x (p + 1)
    Eigen::MatrixXd inverse_root;  // L^-1
    Eigen::MatrixXd free;          // n x (p + 1), z = free (theta, 1) + L^-T v
  };

  OnlineProgram(const ParametricProgram& program, ScaledProgram scaled);

  static std::optional<Transformed> transform(const ParametricProgram& program);
  void sortRows();
  void setBounds(const double* theta) noexcept;
  QpStatus solveTransformed(const double* more) noexcept;
  QpStatus solveGiven(const double* theta, const double* more) noexcept;

  ParametricProgram program_;
  // Of the variables and of the gradient. What follows is about the scaled program.
  Eigen::VectorXd units_, gradient_units_;
  ParametricProgram scaled_;
  std::optional<Transformed> transformed_;
  // Rows that bound one variable; an equality is in both.
  std::vector<Bound> lower_bounds_, upper_bounds_;
  // Columns of S that are not 0.
  std::vector<Eigen::Index> moving_;
  // Rows of the program that are no bounds.
  std::vector<int> rows_;
  std::vector<char> is_equality_;
  BoundedQp qp_;
  Eigen::VectorXd g_, more_, b_, lower_, upper_, row_lower_, row_upper_;
  Eigen::VectorXd affine_;  // (theta, 1)
  Eigen::VectorXd z_;
  bool warm_ = false;
};

}  // namespace polyfly
