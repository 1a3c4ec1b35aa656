// Where the laws expect the vehicle over their horizon, for people to look at.
#include <algorithm>

#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"

namespace polyfly {

void NonlinearController::inspect(const Reference*, LawInsight& insight) const noexcept {
  insight.count = 0;
  insight.kkt_residual = iterating_ ? mpc_.kktResidual() : -1.0;
  if (!iterating_) return;
  insight.count = std::min(insight.room, mpc_.horizon() + 1);
  for (int k = 0; k < insight.count; ++k) insight.positions[k] = mpc_.state(k).head<3>();
}

void MultirotorController::inspect(const Reference* preview, LawInsight& insight) const noexcept {
  insight.count = 0;
  insight.kkt_residual = -1.0;
  for (const Axis& axis : axes_) insight.kkt_residual = std::max(insight.kkt_residual, axis.kktResidual());
  if (!isAnswer(report_.status)) return;
  insight.count = insight.room;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    Axis::Prediction prediction = axes_[i].beginPrediction(report_.axis[i]);
    for (int k = 0; k < insight.room; ++k) {
      insight.positions[k](row) =
          preview[k].position(row) + prediction.values[AxisEntry::kPositionError] - axes_[i].shift(k);
      axes_[i].advance(prediction);
    }
  }
}

// In error coordinates e = x - x_ref, u~ = u - u_ref, as the problem has them.
Axis::Prediction Axis::beginPrediction(const AxisReport& report) const noexcept {
  Prediction prediction;
  for (std::size_t i = 0; i < static_cast<std::size_t>(std::min(report.size, size_)); ++i)
    prediction.values[entries_[i]] = report.theta[i];
  prediction.input = report.input;
  prediction.planned = law_->isSolved();
  return prediction;
}

void Axis::advance(Prediction& at) const noexcept {
  AxisValues& values = at.values;
  std::array<double, 4> error{};
  error[static_cast<std::size_t>(position_state_)] = values[AxisEntry::kPositionError];
  error[static_cast<std::size_t>(velocity_state_)] = values[AxisEntry::kVelocityError];
  if (has_lag_) error[static_cast<std::size_t>(angle_state_)] = values[AxisEntry::kAngleError];
  if (has_rate_) error[static_cast<std::size_t>(rate_state_)] = values[AxisEntry::kAngleRateError];
  std::array<double, 4> next{};
  const auto states = static_cast<std::size_t>(observer_.stateCount());
  for (std::size_t i = 0; i < states; ++i) {
    next[i] = stage_input_[i] * (at.input - values[AxisEntry::kInputReference]);
    for (std::size_t j = 0; j < states; ++j) next[i] += stage_[i][j] * error[j];
    next[i] += stage_disturbance_[i] * values[AxisEntry::kDisturbanceAhead];
  }
  values[AxisEntry::kPositionError] = next[static_cast<std::size_t>(position_state_)];
  values[AxisEntry::kVelocityError] = next[static_cast<std::size_t>(velocity_state_)];
  if (has_lag_) values[AxisEntry::kAngleError] = next[static_cast<std::size_t>(angle_state_)];
  if (has_rate_) values[AxisEntry::kAngleRateError] = next[static_cast<std::size_t>(rate_state_)];
  values[AxisEntry::kPreviousInput] = at.input;
  ++at.stage;
  at.input = nextInput(at);
}

double Axis::nextInput(const Prediction& at) const noexcept {
  double input = at.input;
  if (at.planned && law_->planned(at.stage, at.values[AxisEntry::kInputReference], &input)) return input;
  law_->lookUp(clipped(parametersAt(at.values)).data(), &input);
  return input;
}

}  // namespace polyfly
