#include "online_controller/laws/stage_references.hpp"

#include <cmath>

#include "mpc_core/decompositions.hpp"

namespace polyfly {
namespace {

constexpr int kMostStates = 3;

/// int_0^T e^{A (T - s)} B s / T ds: the end of a ramp's share of the input. With the input and its rate as further
/// states it is a block of the discretised model.
Eigen::MatrixXd endOfRamp(const MpcProblem& problem) {
  const Eigen::Index nx = problem.stateCount();
  MpcProblem ramp = problem;
  ramp.A_c = Eigen::MatrixXd::Zero(nx + 1, nx + 1);
  ramp.A_c.topLeftCorner(nx, nx) = problem.A_c;
  ramp.A_c.topRightCorner(nx, 1) = problem.B_c;
  ramp.B_c = Eigen::MatrixXd::Zero(nx + 1, 1);
  ramp.B_c(nx, 0) = 1.0 / problem.sampling_time;
  ramp.Bd_c = Eigen::MatrixXd::Zero(nx + 1, 1);
  return discretise(ramp, problem.sampling_time).B.topRows(nx);
}

}  // namespace

bool StageReferences::supports(const MpcProblem& problem) {
  if (problem.minimum_peak || problem.inputCount() != 1 || problem.stateCount() > kMostStates ||
      problem.Bd_c.cols() != 1)
    return false;
  // What bounds errors or holds the input over several stages would move with the references.
  if (problem.discrete || !problem.moves.empty() || !problem.constraints.empty() || problem.T.rows() > 0)
    return false;
  for (const Signal& state : problem.states) {
    if (std::isfinite(state.lower) || std::isfinite(state.upper)) return false;
  }
  return true;
}

StageReferences::StageReferences(const MpcProblem& problem)
    : horizon_(problem.horizon), states_(problem.stateCount()) {
  const DiscreteModel model = discretise(problem, problem.sampling_time);
  A_.topLeftCorner(states_, states_) = model.A;
  B_.head(states_) = model.B;
  Bd_.head(states_) = model.Bd;
  B_end_.head(states_) = endOfRamp(problem);
  Q_.topLeftCorner(states_, states_) = problem.Q;
  P_.topLeftCorner(states_, states_) = terminalWeight(problem, model);
  R_ = problem.R(0, 0);
  const auto points = static_cast<std::size_t>(horizon_) + 1;
  x_.assign(points, Eigen::Vector3d::Zero());
  r_ = x_;
  u_.assign(points, 0.0);
  gradient_.assign(points - 1, 0.0);
}

void StageReferences::set(int stage, const double* state, double input) noexcept {
  const auto t = static_cast<std::size_t>(stage);
  for (int i = 0; i < states_; ++i) x_[t](i) = state[i];
  u_[t] = input;
}

// With y_t = r_t - x_ss[t] the recursion of r takes one product with A:
// y_{t+1} = A y_t - B u_ss[0] - B_d d - B_1 (u_ss[t+1] - u_ss[t]).
const double* StageReferences::gradient(double disturbance) noexcept {
  const auto N = static_cast<std::size_t>(horizon_);
  const Eigen::Vector3d held = B_ * u_[0] + Bd_ * disturbance;
  Eigen::Vector3d y = -x_[0];
  for (std::size_t t = 0; t < N; ++t) {
    const Eigen::Vector3d next = A_ * y - held - B_end_ * (u_[t + 1] - u_[t]);
    y = next;
    r_[t + 1] = x_[t + 1] + y;
  }
  Eigen::Vector3d adjoint = P_ * r_[N];
  for (std::size_t t = N; t-- > 0;) {
    gradient_[t] = -2.0 * (B_.dot(adjoint) + R_ * (u_[t] - u_[0]));
    const Eigen::Vector3d before = Q_ * r_[t] + A_.transpose() * adjoint;
    adjoint = before;
  }
  return gradient_.data();
}

}  // namespace polyfly
