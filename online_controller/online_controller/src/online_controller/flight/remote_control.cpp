#include "online_controller/flight/remote_control.hpp"

#include <algorithm>
#include <cmath>

#include "online_controller/types/attitude.hpp"

namespace polyfly {
namespace {

constexpr double kManualThrust = 1.6;  // full stick, times hovering: the middle lies below hovering

double clipped(double stick) noexcept { return std::isfinite(stick) ? std::clamp(stick, -1.0, 1.0) : 0.0; }

}  // namespace

double beyondDeadzone(double stick, double zone) noexcept {
  const double value = clipped(stick);
  if (std::abs(value) <= zone) return 0.0;
  return std::copysign((std::abs(value) - zone) / (1.0 - zone), value);
}

bool isActive(const RemoteControl& sticks, double zone) noexcept {
  for (const double stick : {sticks.forward, sticks.left, sticks.up, sticks.turn}) {
    if (beyondDeadzone(stick, zone) != 0.0) return true;
  }
  return false;
}

AttitudeCommand manualCommand(const RemoteControl& sticks, const FlightOptions& options,
                              const MultirotorOptions& vehicle) noexcept {
  AttitudeCommand command;
  command.pitch = clipped(sticks.forward) * options.rc_max_roll_pitch_command;
  command.roll = -clipped(sticks.left) * options.rc_max_roll_pitch_command;
  command.yaw_rate = clipped(sticks.turn) * options.rc_max_yaw_rate_command;
  const double up = std::isfinite(sticks.up) ? clipped(sticks.up) : -1.0;
  const double thrust = 0.5 * (up + 1.0) * kManualThrust * vehicle.gravity;
  command.thrust = vehicle.mass * std::min(thrust, vehicle.thrust_max);
  return command;
}

Reference carrot(const RemoteControl& sticks, const VehicleState& state, const Reference& held,
                 const FlightOptions& options) noexcept {
  Eigen::Vector3d ahead(beyondDeadzone(sticks.forward, options.stick_deadzone),
                        beyondDeadzone(sticks.left, options.stick_deadzone),
                        beyondDeadzone(sticks.up, options.stick_deadzone));
  if (ahead.norm() > 1.0) ahead.normalize();
  ahead *= options.rc_teleop_max_carrot_distance_position;
  const double yaw = eulerAngles(state.attitude.normalized()).yaw;
  const double c = std::cos(yaw), s = std::sin(yaw);
  Reference reference;
  reference.position = held.position;
  reference.yaw = held.yaw;
  if (ahead.x() != 0.0 || ahead.y() != 0.0) {
    reference.position.x() = state.position.x() + c * ahead.x() - s * ahead.y();
    reference.position.y() = state.position.y() + s * ahead.x() + c * ahead.y();
  }
  if (ahead.z() != 0.0) reference.position.z() = state.position.z() + ahead.z();
  const double turn = beyondDeadzone(sticks.turn, options.stick_deadzone);
  if (turn != 0.0) reference.yaw = wrapAngle(yaw + turn * options.rc_teleop_max_carrot_distance_yaw);
  return reference;
}

}  // namespace polyfly
