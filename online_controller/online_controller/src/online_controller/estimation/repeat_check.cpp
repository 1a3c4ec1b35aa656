#include "online_controller/estimation/repeat_check.hpp"

#include <cmath>
#include <utility>

namespace polyfly {
namespace {

// Speed above which the vehicle moves [m/s].
constexpr double kMovingSpeed = 0.2;
// Rate above which the vehicle turns [rad/s].
constexpr double kTurningRate = 0.2;
// Greatest rounding when a velocity is turned into the body frame [SI].
constexpr double kSameTwist = 1e-9;
// Difference of tilt above which two commands ask for different motions [rad].
constexpr double kOtherTilt = 0.05;
// Difference of yaw rate above which two commands ask for different motions [rad/s].
constexpr double kOtherYawRate = 0.1;
// Share of the weight; with less thrust the vehicle may stand.
constexpr double kCarryingShare = 0.95;
// Share of the weight; with more thrust the vehicle cannot stand.
constexpr double kLiftingShare = 1.2;

bool isSamePose(const VehicleState& a, const VehicleState& b) noexcept {
  return a.position == b.position && a.attitude.coeffs() == b.attitude.coeffs();
}

Eigen::Vector3d bodyVelocity(const VehicleState& state) noexcept {
  return state.attitude.conjugate() * state.velocity;
}

// Velocities are turned by the attitude, which goes on; that of the message is the one in the body.
bool isSameTwist(const VehicleState& a, const VehicleState& b) noexcept {
  const Eigen::Vector3d velocity = bodyVelocity(a);
  if (velocity.norm() <= kSameTwist && a.angular_velocity.norm() <= kSameTwist) return false;
  return (bodyVelocity(b) - velocity).norm() <= kSameTwist && a.angular_velocity == b.angular_velocity;
}

bool isOtherMotion(const AttitudeCommand& from, const AttitudeCommand& to, double weight) noexcept {
  const bool turns = std::abs(to.roll - from.roll) > kOtherTilt ||
                     std::abs(to.pitch - from.pitch) > kOtherTilt ||
                     std::abs(to.yaw_rate - from.yaw_rate) > kOtherYawRate;
  const double lifting = kLiftingShare * weight;
  return (turns && to.thrust > kCarryingShare * weight) || (to.thrust > lifting && from.thrust <= lifting);
}

}  // namespace

void RepeatCheck::Stretch::add(const VehicleState& before, const VehicleState& state) noexcept {
  const double elapsed = state.stamp - before.stamp;
  moved += 0.5 * elapsed * (before.velocity + state.velocity);
  turned += 0.5 * elapsed * (before.angular_velocity + state.angular_velocity);
}

bool RepeatCheck::repeats(const VehicleState& state, double repeat_time) noexcept {
  const bool follows = started_ && state.stamp >= last_.stamp;
  const bool same_pose = follows && isSamePose(pose_.first, state);
  const bool same_twist = follows && isSameTwist(twist_.first, state);
  for (auto [stretch, same] : {std::pair{&pose_, same_pose}, std::pair{&twist_, same_twist}}) {
    if (same) {
      stretch->add(last_, state);
    } else {
      *stretch = Stretch{};
      stretch->first = state;
    }
  }
  last_ = state;
  started_ = true;
  if (repeat_time <= 0.0) return false;
  const auto is_long = [&](double since) { return state.stamp - since > repeat_time; };
  for (const Stretch* stretch : {&pose_, &twist_}) {
    const double time = state.stamp - stretch->first.stamp;
    const Eigen::Vector3d went = state.position - stretch->first.position;
    const bool moves = (went - stretch->moved).norm() > kMovingSpeed * time;
    // Written so that NaN in the rates is no motion.
    const bool turns = stretch == &pose_ && stretch->turned.norm() > kTurningRate * time;
    if (is_long(stretch->first.stamp) && (moves || turns)) return true;
    if (stretch->asked && is_long(stretch->asked_at)) return true;
  }
  return false;
}

void RepeatCheck::commanded(const AttitudeCommand& command, const MultirotorOptions& vehicle) noexcept {
  for (Stretch* stretch : {&pose_, &twist_}) {
    if (!stretch->has_command) {
      stretch->command = command;
      stretch->has_command = true;
    } else if (!stretch->asked && isOtherMotion(stretch->command, command, vehicle.mass * vehicle.gravity)) {
      stretch->asked = true;
      stretch->asked_at = last_.stamp;
    }
  }
}

}  // namespace polyfly
