#include "online_controller/types/attitude.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

constexpr double kPi = 3.14159265358979323846;

}  // namespace

EulerAngles eulerAngles(const Eigen::Quaterniond& attitude) noexcept {
  const double w = attitude.w();
  const double x = attitude.x();
  const double y = attitude.y();
  const double z = attitude.z();
  EulerAngles angles;
  angles.roll = std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y));
  angles.pitch = std::asin(std::clamp(2.0 * (w * y - z * x), -1.0, 1.0));
  angles.yaw = std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
  return angles;
}

Eigen::Quaterniond attitudeOf(const EulerAngles& angles) noexcept {
  return Eigen::AngleAxisd(angles.yaw, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(angles.pitch, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(angles.roll, Eigen::Vector3d::UnitX());
}

double wrapAngle(double angle) noexcept {
  if (angle >= -kPi && angle < kPi) return angle;
  const double wrapped = angle - 2.0 * kPi * std::floor((angle + kPi) / (2.0 * kPi));
  // Rounding can leave pi itself.
  return wrapped < kPi ? wrapped : -kPi;
}

TiltAngles worldToBodyTilt(const TiltAngles& world, double yaw) noexcept {
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  return {c * world.roll + s * world.pitch, c * world.pitch - s * world.roll};
}

TiltAngles bodyToWorldTilt(const TiltAngles& body, double yaw) noexcept {
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  return {c * body.roll - s * body.pitch, c * body.pitch + s * body.roll};
}

EulerAngles eulerRates(const EulerAngles& angles, const Eigen::Vector3d& rates) noexcept {
  const double sine = std::sin(angles.roll), cosine = std::cos(angles.roll);
  const double turn =
      (sine * rates.y() + cosine * rates.z()) / std::max(std::cos(angles.pitch), kLeastTiltCosine);
  return {rates.x() + std::sin(angles.pitch) * turn, cosine * rates.y() - sine * rates.z(), turn};
}

TiltAngles worldTiltRate(const EulerAngles& angles, const Eigen::Vector3d& rates) noexcept {
  const EulerAngles own = eulerRates(angles, rates);
  const TiltAngles tilting = bodyToWorldTilt({own.roll, own.pitch}, angles.yaw);
  const TiltAngles turning = bodyToWorldTilt({angles.roll, angles.pitch}, angles.yaw + 0.5 * kPi);
  return {tilting.roll + own.yaw * turning.roll, tilting.pitch + own.yaw * turning.pitch};
}

double tiltCosine(const TiltAngles& tilt) noexcept {
  return std::max(std::cos(tilt.roll) * std::cos(tilt.pitch), kLeastTiltCosine);
}

double compensatedThrust(double thrust, const TiltAngles& tilt, double gravity,
                         double acceleration_z) noexcept {
  return (thrust + gravity) / tiltCosine(tilt) + acceleration_z;
}

TiltAngles compensatedTilt(const TiltAngles& tilt, double total_thrust, double gravity, double acceleration_x,
                           double acceleration_y) noexcept {
  return {(gravity * tilt.roll - acceleration_y) / total_thrust,
          (gravity * tilt.pitch + acceleration_x) / total_thrust};
}

}  // namespace polyfly
