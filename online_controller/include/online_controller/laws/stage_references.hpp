#pragma once

#include <Eigen/Core>
#include <vector>

#include "mpc_core/mpc_problem.hpp"

namespace polyfly {

/// References of the stages of Eq. 38, x_ss[t] and u_ss[t], in the condensed problem of one axis (one input).
///
/// The condensed problem holds the reference of the first stage: with z_t = u_t - u_ss[0], its states are
/// s_{t+1} = A s_t + B z_t, s_0 = e_0. The errors of Eq. 38 are e_t = s_t - r_t with r_0 = 0 and
///
///     r_{t+1} = A r_t + B rho_t - w_t,     rho_t = u_ss[t] - u_ss[0],
///     w_t = A x_ss[t] + B_0 u_ss[t] + B_1 u_ss[t+1] + B_d d - x_ss[t+1],
///
/// where B_0 + B_1 = B: between stages the input's reference runs straight, and the deviation from it is held. So a
/// reference that the model can follow has w_t = 0 up to its snap, and w_t holds what it cannot follow, as a corner. The
/// costs of e_t and of z_t - rho_t add to the gradient, by the adjoint of the prediction,
///
///     -2 (B' lambda_{t+1} + R rho_t),     lambda_N = P r_N,  lambda_t = Q r_t + A' lambda_{t+1}.
///
/// Bounds of the input and the cost of its changes do not move. offline_mpt/NOTATION.md has the condensed problem.
class StageReferences {
 public:
  /// Whether stages can have references of their own: a continuous model with one input and three states at most; no
  /// bounds but those of the input and its change; no blocks.
  static bool supports(const MpcProblem& problem);

  /// For problems that are supported. Throws Error as discretise() and solveRiccati() do.
  explicit StageReferences(const MpcProblem& problem);

  int horizon() const noexcept { return horizon_; }

  /// x_ss[t] in the order of the problem's states, and u_ss[t], at stage t = 0 .. horizon(). Never allocates or throws.
  void set(int stage, const double* state, double input) noexcept;

  /// What the references that were set add to the gradient, horizon() numbers, under the constant disturbance d.
  const double* gradient(double disturbance) noexcept;

  /// r_t of the last gradient(), in the order of the problem's states.
  const Eigen::Vector3d& shift(int stage) const noexcept { return r_[static_cast<std::size_t>(stage)]; }

 private:
  int horizon_;
  int states_;
  // Filled with zeros up to three states.
  Eigen::Matrix3d A_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d B_ = Eigen::Vector3d::Zero();
  // Share of B of the input's reference at the end of a stage.
  Eigen::Vector3d B_end_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d Bd_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d Q_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d P_ = Eigen::Matrix3d::Zero();
  double R_ = 0.0;
  std::vector<Eigen::Vector3d> x_, r_;  // horizon + 1
  std::vector<double> u_;               // horizon + 1
  std::vector<double> gradient_;        // horizon
};

}  // namespace polyfly
