#pragma once

#include <ros/time.h>

#include <algorithm>
#include <cstdint>

namespace polyfly_ros {

/// Stamps come from outside: any is possible, also 4294967295. ros::Time and ros::Duration throw where a difference exceeds
/// 2^31 s or a sum 2^32 s. These functions compute in 64 bits and never throw.

/// From `earlier` to `later` [s]; negative where they are the other way round.
inline double secondsBetween(const ros::Time& earlier, const ros::Time& later) noexcept {
  const auto nanoseconds =
      static_cast<std::int64_t>(later.toNSec()) - static_cast<std::int64_t>(earlier.toNSec());
  return 1e-9 * static_cast<double>(nanoseconds);
}

/// The time [s] as a stamp: the nearest one that a message can bear.
inline ros::Time stampOf(double seconds) noexcept {
  constexpr double kSecond = 1e9;             // [ns]
  constexpr double kGreatest = 4294967295.0;  // [s]
  // Written so that NaN is 0.
  const double held = seconds > 0.0 ? std::min(seconds, kGreatest) : 0.0;
  const auto whole = static_cast<std::uint32_t>(held);
  const auto rest = static_cast<std::uint32_t>((held - whole) * kSecond);
  return {whole, rest};
}

}  // namespace polyfly_ros
