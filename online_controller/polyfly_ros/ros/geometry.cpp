#include "polyfly_ros/geometry.hpp"

#include <cmath>
#include <limits>

namespace polyfly_ros {

Eigen::Quaterniond toAttitude(const geometry_msgs::Quaternion& message) noexcept {
  // Tolerance of a quaternion's length.
  constexpr double kUnitTolerance = 0.05;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Quaterniond raw(message.w, message.x, message.y, message.z);
  if (std::abs(raw.norm() - 1.0) <= kUnitTolerance) return raw.normalized();
  return {kNan, kNan, kNan, kNan};
}

}  // namespace polyfly_ros
