#include "fixedwing_lateral/air_data.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

// Time constant of the filter on the wind from ground velocity [s].
constexpr double kAssumedWindTime = 3.0;
// Time in which the wind follows the difference of ground and air velocity [s].
constexpr double kCorrectionTime = 0.3;
// Least airspeed that the model receives [m/s].
constexpr double kLeastAirspeed = 1.0;

bool isRecent(double stamp, double time, double timeout) noexcept {
  return time - stamp <= timeout && stamp - time <= timeout;
}

}  // namespace

AirData::AirData(const GuidanceOptions& options)
    : safety_(options.safety),
      nominal_(options.airspeed_nominal),
      correction_time_(options.corrects_wind ? kCorrectionTime : 0.0),
      airspeed_(options.airspeed_nominal) {}

void AirData::update(double time, const StampedAirspeed& airspeed, const StampedWind& wind,
                     const Eigen::Vector2d& ground_velocity, double heading) noexcept {
  airspeed_assumed_ = !std::isfinite(airspeed.value) || airspeed.value < 0.0 ||
                      !isRecent(airspeed.stamp, time, safety_.airspeed_timeout);
  const double speed = airspeed_assumed_ ? nominal_ : airspeed.value;
  slow_ = speed < safety_.airspeed_min * (slow_ ? 1.0 + kHysteresis : 1.0);
  airspeed_ = std::max(speed, kLeastAirspeed);

  const double elapsed = std::max(0.0, time - last_time_);
  last_time_ = time;
  const Eigen::Vector2d air = airspeed_ * Eigen::Vector2d(std::cos(heading), std::sin(heading));
  wind_assumed_ = !wind.value.allFinite() || !isRecent(wind.stamp, time, safety_.wind_timeout);
  if (!wind_assumed_) estimate_ = wind.value;
  // What the ground velocity has and the estimate has not: gusts, and what heading and airspeed are off by.
  const double time_constant = wind_assumed_ ? kAssumedWindTime : correction_time_;
  if (time_constant > 0.0) {
    const Eigen::Vector2d missing = ground_velocity - air - estimate_;
    correction_ += std::min(1.0, elapsed / time_constant) * (missing - correction_);
  }
  wind_ = estimate_ + correction_;
  const double strong = safety_.wind_share_max * airspeed_;
  windy_ = wind_.norm() > strong * (windy_ ? 1.0 - kHysteresis : 1.0);
}

}  // namespace polyfly
