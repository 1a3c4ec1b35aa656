#include "online_controller/estimation/position_integrator.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

constexpr double kLongestStep = 0.1;  // a longer gap integrates as this [s]
constexpr double kAtLimit = 1e-9;     // [rad, N]

bool isLimited(const ControlReport& last, const MultirotorOptions& options) noexcept {
  const AttitudeCommand& command = last.command;
  const bool own = last.status == ControlStatus::kOptimal || last.status == ControlStatus::kSuboptimal;
  return !own || std::abs(command.roll) >= options.angle_max - kAtLimit ||
         std::abs(command.pitch) >= options.angle_max - kAtLimit ||
         command.thrust <= options.mass * options.thrust_min + kAtLimit ||
         command.thrust >= options.mass * options.thrust_max - kAtLimit;
}

}  // namespace

void PositionIntegrator::update(const VehicleState& state, const Reference& reference,
                                const ControlReport& last) noexcept {
  if (!options_.integrator) return;
  const double elapsed = std::clamp(state.stamp - last_stamp_, 0.0, kLongestStep);
  const bool runs = started_ && !isLimited(last, options_);
  started_ = true;
  last_stamp_ = state.stamp;
  if (!runs) return;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double error = state.position(i) - reference.position(i);
    if (std::abs(error) > options_.antiwindup_ball) continue;
    integral_(i) =
        std::clamp(integral_(i) + elapsed * error, -options_.integral_limit, options_.integral_limit);
  }
}

void PositionIntegrator::reset() noexcept {
  integral_.setZero();
  started_ = false;
}

void PositionIntegrator::transferState(const PositionIntegrator& other) noexcept {
  integral_ = other.integral_.cwiseMax(-options_.integral_limit).cwiseMin(options_.integral_limit);
  last_stamp_ = other.last_stamp_;
  started_ = other.started_;
}

Eigen::Vector3d PositionIntegrator::disturbance() const noexcept {
  if (!options_.integrator) return Eigen::Vector3d::Zero();
  return integral_.cwiseProduct(
      Eigen::Vector3d(options_.integral_gain_xy, options_.integral_gain_xy, options_.integral_gain_z));
}

}  // namespace polyfly
