#pragma once

#include <algorithm>

#include "online_controller/types/attitude.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// The rate that is commanded at `yaw` [rad]: the reference's, and what turns the vehicle towards the
/// reference's yaw, within the limit [rad/s].
inline double yawRate(const MultirotorOptions& options, const Reference& reference, double yaw) noexcept {
  const double rate = options.yaw_gain * wrapAngle(reference.yaw - yaw) + reference.yaw_rate;
  return std::clamp(rate, -options.yaw_rate_max, options.yaw_rate_max);
}

}  // namespace polyfly
