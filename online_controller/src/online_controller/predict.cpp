// Where the laws expect the vehicle over their horizon, for people to look at.
#include <algorithm>

#include "online_controller/law_switch.hpp"
#include "online_controller/multirotor_controller.hpp"
#include "online_controller/nonlinear_controller.hpp"

namespace polyfly {

int NonlinearController::predict(const Reference*, int count, Eigen::Vector3d* positions) const noexcept {
  if (!iterating_) return 0;
  const int stages = std::min(count, mpc_.horizon() + 1);
  for (int k = 0; k < stages; ++k) positions[k] = mpc_.state(k).head<3>();
  return stages;
}

int MultirotorController::predict(const Reference* preview, int count,
                                  Eigen::Vector3d* positions) const noexcept {
  if (report_.status > ControlStatus::kClipped) return 0;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    Axis::Prediction prediction = axes_[i].beginPrediction(report_.axis[i]);
    for (int k = 0; k < count; ++k) {
      positions[k](static_cast<Eigen::Index>(i)) =
          preview[k].position(static_cast<Eigen::Index>(i)) + prediction.position_error;
      axes_[i].advance(prediction);
    }
  }
  return count;
}

// In error coordinates e = x - x_ref, u~ = u - u_ref, as the problem has them.
Axis::Prediction Axis::beginPrediction(const AxisReport& report) const noexcept {
  Prediction prediction;
  for (std::size_t i = 0; i < static_cast<std::size_t>(std::min(report.size, size_)); ++i) {
    const double value = report.theta[i];
    switch (entries_[i]) {
      case Entry::kPositionError:
        prediction.position_error = value;
        break;
      case Entry::kVelocityError:
        prediction.velocity_error = value;
        break;
      case Entry::kAngleError:
        prediction.angle_error = value;
        break;
      case Entry::kInputReference:
        prediction.input_reference = value;
        break;
      case Entry::kPreviousInput:
      case Entry::kVelocityReference:
        break;
    }
  }
  prediction.input = report.input;
  return prediction;
}

void Axis::advance(Prediction& at) const noexcept {
  std::array<double, 3> error{};
  error[static_cast<std::size_t>(position_state_)] = at.position_error;
  error[static_cast<std::size_t>(velocity_state_)] = at.velocity_error;
  if (has_lag_) error[static_cast<std::size_t>(angle_state_)] = at.angle_error;
  std::array<double, 3> next{};
  const std::size_t states = has_lag_ ? 3 : 2;
  for (std::size_t i = 0; i < states; ++i) {
    next[i] = stage_input_[i] * (at.input - at.input_reference);
    for (std::size_t j = 0; j < states; ++j) next[i] += stage_[i][j] * error[j];
  }
  at.position_error = next[static_cast<std::size_t>(position_state_)];
  at.velocity_error = next[static_cast<std::size_t>(velocity_state_)];
  if (has_lag_) at.angle_error = next[static_cast<std::size_t>(angle_state_)];
  ++at.stage;
  at.input = nextInput(at);
}

double Axis::nextInput(const Prediction& at) const noexcept {
  double input = 0.0;
  if (law_->planned(at.stage, at.input_reference, &input)) return input;
  std::array<double, kMaxParameters> theta{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(size_); ++i) {
    switch (entries_[i]) {
      case Entry::kPositionError:
        theta[i] = at.position_error;
        break;
      case Entry::kVelocityError:
        theta[i] = at.velocity_error;
        break;
      case Entry::kAngleError:
        theta[i] = at.angle_error;
        break;
      case Entry::kPreviousInput:
        theta[i] = at.input;
        break;
      case Entry::kInputReference:
        theta[i] = at.input_reference;
        break;
      case Entry::kVelocityReference:
        break;
    }
    theta[i] = std::clamp(theta[i], lower_[i], upper_[i]);
  }
  input = at.input;
  law_->lookUp(theta.data(), &input);
  return input;
}

}  // namespace polyfly
