#include "fixedwing_lateral/horizon_qp.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

constexpr int kStates = 5;
constexpr int kRoll = 3;

using State = Eigen::Matrix<double, kStates, 1>;
using Condensing = StageCondensing<kStates, 1>;

void setModel(const HorizonStage& s, const RollTransition& roll, Condensing::Stage& stage) noexcept {
  stage.A << 1.0, 0.0, s.n_psi, s.n_phi, s.n_p,  //
      0.0, 1.0, s.e_psi, s.e_phi, s.e_p,         //
      0.0, 0.0, 1.0, s.psi_phi, s.psi_p,         //
      0.0, 0.0, 0.0, roll.phi_phi, roll.phi_p,   //
      0.0, 0.0, 0.0, roll.p_phi, roll.p_p;
  stage.B << s.n_u, s.e_u, s.psi_u, roll.phi_u, roll.p_u;
}

Condensing::StateMatrix weightOf(const HorizonStage& s) noexcept {
  Condensing::StateMatrix Q;
  Q << s.Q_nn, s.Q_ne, s.Q_npsi, 0.0, 0.0,       //
      s.Q_ne, s.Q_ee, s.Q_epsi, 0.0, 0.0,        //
      s.Q_npsi, s.Q_epsi, s.Q_psipsi, 0.0, 0.0,  //
      0.0, 0.0, 0.0, s.Q_phi, 0.0,               //
      0.0, 0.0, 0.0, 0.0, s.Q_p;
  return Q;
}

}  // namespace

HorizonQp::HorizonQp(int horizon)
    : N_(horizon),
      stages_(horizon + 1),
      bounds_(2 * horizon),
      condensing_(horizon),
      qp_(horizon, horizon),
      x_(kStates * (horizon + 1)),
      multiplier_(2 * horizon),
      rows_(static_cast<std::size_t>(horizon) * horizon),
      gradient_(horizon),
      lower_(2 * horizon),
      upper_(2 * horizon) {}

bool HorizonQp::prepare() noexcept {
  // Not finite where one of the numbers is not finite.
  double sum = 0.0;
  for (int k = 0; k < N_; ++k) {
    const HorizonStage& s = stages_[k];
    Condensing::Stage& stage = condensing_.stages()[k];
    setModel(s, roll, stage);
    stage.weight.topLeftCorner<kStates, kStates>() = weightOf(s);
    stage.weight(kStates, kStates) = s.R;
    sum += s.r;
    for (int i = 0; i < kStates; ++i) sum += s.q[i] + s.gap[i];
  }
  condensing_.terminalWeight() = weightOf(stages_[N_]);
  condensing_.condense();
  for (int k = 0; k < N_; ++k) {
    const double* by_moves = condensing_.sensitivity(k + 1, kRoll);
    for (int j = 0; j <= k; ++j) rows_[j * N_ + k] = by_moves[j];
    qp_.setPenalty(k, rho);
  }
  qp_.setRows(rows_.data());
  return std::isfinite(sum) && qp_.setHessian(condensing_.hessian());
}

QpStatus HorizonQp::solve(const double* x_0) noexcept {
  rollOut(x_0, nullptr);
  linearTerms();
  for (int k = 0; k < N_; ++k) {
    lower_[k] = bounds_[k].lower;
    upper_[k] = bounds_[k].upper;
    const double roll_at_rest = x_[kStates * (k + 1) + kRoll];
    lower_[N_ + k] = bounds_[N_ + k].lower - roll_at_rest;
    upper_[N_ + k] = bounds_[N_ + k].upper - roll_at_rest;
  }
  const QpStatus status =
      qp_.solve({gradient_.data(), lower_.data(), upper_.data(), lower_.data() + N_, upper_.data() + N_},
                is_warm_ ? qp_.activeSet() : nullptr);
  is_warm_ = status == QpStatus::kOptimal;
  std::copy_n(qp_.multipliers(), 2 * N_, multiplier_.data());
  rollOut(x_0, qp_.x());
  return status;
}

void HorizonQp::coldStart() noexcept {
  is_warm_ = false;
  std::fill(multiplier_.begin(), multiplier_.end(), 0.0);
}

int HorizonQp::activeCount() const noexcept {
  return 2 * N_ - static_cast<int>(std::count(qp_.activeSet(), qp_.activeSet() + 2 * N_, QpSide::kInactive));
}

void HorizonQp::rollOut(const double* x_0, const double* moves) noexcept {
  std::copy_n(x_0, kStates, x_.data());
  for (int k = 0; k < N_; ++k) {
    const Condensing::Stage& stage = condensing_.stages()[k];
    const Eigen::Map<const State> x(&x_[kStates * k]), gap(stages_[k].gap);
    Eigen::Map<State> next(&x_[kStates * (k + 1)]);
    next.noalias() = stage.A * x + gap;
    if (moves != nullptr) next += stage.B * moves[k];
  }
}

// The cost's gradient by the moves, along the states without moves.
void HorizonQp::linearTerms() noexcept {
  State adjoint = State::Zero();
  for (int k = N_; k >= 0; --k) {
    const Eigen::Map<const State> x(&x_[kStates * k]), q(stages_[k].q);
    if (k == N_) {
      adjoint = condensing_.terminalWeight() * x + q;
      continue;
    }
    const Condensing::Stage& stage = condensing_.stages()[k];
    gradient_[k] = stages_[k].r + stage.B.dot(adjoint);
    adjoint = (stage.A.transpose() * adjoint + stage.weight.topLeftCorner<kStates, kStates>() * x + q).eval();
  }
}

}  // namespace polyfly
