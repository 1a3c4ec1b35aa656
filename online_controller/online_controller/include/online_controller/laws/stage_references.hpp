#pragma once

#include <Eigen/Core>
#include <vector>

#include "mpc_core/aligned_array.hpp"
#include "mpc_core/mpc_problem.hpp"

namespace polyfly {

/// Position, velocity, acceleration and jerk of one axis' reference.
constexpr int kReferenceDerivatives = 4;

/// References of the stages of Eq. 38, x_ss[t] and u_ss[t], in the condensed problem of one axis (one input).
///
/// The condensed problem holds the reference of the first stage: with z_t = u_t - u_ss[0], its states are
/// s_{t+1} = A s_t + B z_t, s_0 = e_0. The errors of Eq. 38 are e_t = s_t - r_t with r_0 = 0 and
///
///     r_{t+1} = A r_t + B rho_t - w_t,     rho_t = u_ss[t] - u_ss[0],
///     w_t = A x_ss[t] + B_0 u_ss[t] + B_1 u_ss[t+1] - x_ss[t+1],
///
/// where B_0 + B_1 = B: between stages the input's reference runs straight, and the deviation from it is held. So a
/// reference that the model can follow has w_t = 0 up to its snap, and w_t holds what it cannot follow, as a corner. A
/// constant disturbance is held by the targets and adds nothing. The costs of e_t and of z_t - rho_t add to the gradient,
/// by the adjoint of the prediction,
///
///     -2 (B' lambda_{t+1} + R rho_t),     lambda_N = P r_N,  lambda_t = Q r_t + A' lambda_{t+1},
///
/// summed over the stages of a block where the problem has moves. All of it is linear in the references, so a matrix is
/// computed once, and a sample takes one product.
///
/// Bounds of the input and the cost of its changes do not move. offline_mpt/NOTATION.md has the condensed problem.
class StageReferences {
 public:
  /// How x_ss (in the order of the problem's states) and then u_ss follow from the reference of a stage: a row for each
  /// entry.
  using Targets = Eigen::Matrix<double, Eigen::Dynamic, kReferenceDerivatives>;

  /// Whether stages can have references of their own: a continuous model with one input; no bounds but those of the
  /// input and its change.
  static bool supports(const MpcProblem& problem);

  /// For problems that are supported. Throws Error as discretise() and solveRiccati() do.
  StageReferences(const MpcProblem& problem, const Targets& targets);

  int horizon() const noexcept { return horizon_; }

  /// The reference of stage t = 0 .. horizon(). Never allocates or throws.
  void set(int stage, double position, double velocity, double acceleration, double jerk) noexcept {
    double* const reference = references_.data() + kReferenceDerivatives * stage;
    reference[0] = position;
    reference[1] = velocity;
    reference[2] = acceleration;
    reference[3] = jerk;
  }

  /// What the references that were set add to the gradient, a number for each block of moves.
  const double* gradient() noexcept;

  /// The greatest magnitude among the references that were set; not finite where one is not.
  double greatest() const noexcept;

  /// The row that gives, times the references that were set, the sum of the gradient's entries times `weights`.
  Eigen::RowVectorXd gradientRow(const Eigen::RowVectorXd& weights) const;

  /// `row` of gradientRow() times the references that were set. Never allocates or throws.
  double along(const Eigen::RowVectorXd& row) const noexcept;

  /// r_t of the references that were set, entry `state`. Never allocates or throws.
  double shift(int stage, int state) const noexcept;

 private:
  int horizon_;
  int states_;
  int blocks_;
  // Number of blocks in whole packs.
  int stride_;
  // Column i: the gradient by the i-th reference entry; stage by stage.
  AlignedArray by_reference_;
  AlignedArray references_, gradient_;
  // r_1 .. r_N by the reference entries.
  Eigen::MatrixXd shift_by_reference_;
};

}  // namespace polyfly
