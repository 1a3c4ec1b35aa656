#include "polyfly_test/pi_controller.hpp"

#include <algorithm>
#include <cmath>

#include "online_controller/reference/yaw_rate.hpp"
#include "online_controller/types/attitude.hpp"

namespace polyfly {
namespace {

constexpr double kProportional = 6.0;  // [1/s^2]
constexpr double kDerivative = 4.5;    // [1/s]
constexpr double kIntegral = 1.2;      // [1/s^3]

}  // namespace

AttitudeCommand PiController::step(const VehicleState& state, const Reference& reference) {
  const Eigen::Vector3d error = reference.position - state.position;
  const Eigen::Vector3d rate = reference.velocity - state.velocity;
  const Eigen::Vector3d integral = integral_ + options_.control_period * error;
  const Eigen::Vector3d wanted = reference.acceleration + kProportional * error + kDerivative * rate +
                                 kIntegral * integral + Eigen::Vector3d(0.0, 0.0, options_.gravity);
  const EulerAngles angles = eulerAngles(state.attitude);
  const Eigen::Vector3d force = Eigen::AngleAxisd(-angles.yaw, Eigen::Vector3d::UnitZ()) * wanted;
  const Eigen::Vector3d up = state.attitude * Eigen::Vector3d::UnitZ();
  const double roll = -std::asin(force.y() / force.norm());
  const double pitch = std::atan2(force.x(), force.z());
  const double thrust = wanted.dot(up);
  AttitudeCommand command;
  command.roll = std::clamp(roll, -options_.angle_max, options_.angle_max);
  command.pitch = std::clamp(pitch, -options_.angle_max, options_.angle_max);
  const double limited = std::clamp(thrust, options_.thrust_min, options_.thrust_max);
  command.thrust = options_.mass * limited;
  command.yaw_rate = yawRate(options_, reference, angles.yaw);
  if (command.roll == roll && command.pitch == pitch && limited == thrust) integral_ = integral;
  return command;
}

}  // namespace polyfly
