#include "fixedwing_lateral/horizon_qp.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {

using State = HorizonStage::State;

HorizonQp::HorizonQp(int horizon)
    : N_(horizon),
      stages_(horizon + 1),
      bounds_(2 * horizon),
      condensing_(horizon),
      qp_(horizon, horizon),
      x_(horizon + 1),
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
    auto& stage = condensing_.stages()[k];
    stage.A = s.A;
    stage.B = s.B;
    stage.weight.topLeftCorner<5, 5>() = s.Q;
    stage.weight(5, 5) = s.R;
    sum += s.r + s.q.sum() + s.gap.sum();
  }
  condensing_.terminalWeight() = stages_[N_].Q;
  condensing_.condense();
  for (int k = 0; k < N_; ++k) {
    const double* by_moves = condensing_.sensitivity(k + 1, HorizonStage::kRoll);
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
    const double roll_at_rest = x_[k + 1][HorizonStage::kRoll];
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
  x_[0] = Eigen::Map<const State>(x_0);
  for (int k = 0; k < N_; ++k) {
    x_[k + 1].noalias() = stages_[k].A * x_[k] + stages_[k].gap;
    if (moves != nullptr) x_[k + 1] += stages_[k].B * moves[k];
  }
}

// The cost's gradient by the moves, along the states without moves.
void HorizonQp::linearTerms() noexcept {
  State adjoint = stages_[N_].Q * x_[N_] + stages_[N_].q;
  for (int k = N_ - 1; k >= 0; --k) {
    const HorizonStage& s = stages_[k];
    gradient_[k] = s.r + s.B.dot(adjoint);
    adjoint = (s.A.transpose() * adjoint + s.Q * x_[k] + s.q).eval();
  }
}

}  // namespace polyfly
