#pragma once

#include <geometry_msgs/Quaternion.h>

#include <Eigen/Geometry>

namespace polyfly_ros {

/// Of unit length. All NaN where the message's length differs from 1 by more than 0.05, or is not finite.
Eigen::Quaterniond toAttitude(const geometry_msgs::Quaternion& message) noexcept;

}  // namespace polyfly_ros
