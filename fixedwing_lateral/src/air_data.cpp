#include "fixedwing_lateral/air_data.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

constexpr double kAssumedWindTime = 3.0;  // of the filter on the wind from ground velocity [s]
constexpr double kLeastAirspeed = 1.0;    // that the model is given [m/s]

bool isRecent(double stamp, double time, double timeout) noexcept {
  return time - stamp <= timeout && stamp - time <= timeout;
}

/// A limit that, once exceeded, is left again only with a margin.
bool exceeds(double value, double limit, bool before, double margin) noexcept {
  return value > (before ? limit * (1.0 - margin) : limit);
}

}  // namespace

AirData::AirData(const GuidanceOptions& options)
    : safety_(options.safety), nominal_(options.airspeed_nominal), airspeed_(options.airspeed_nominal) {}

void AirData::update(double time, const Stamped<double>& airspeed, const Stamped<Eigen::Vector2d>& wind,
                     const Eigen::Vector2d& ground_velocity, double heading) noexcept {
  airspeed_assumed_ = !std::isfinite(airspeed.value) || airspeed.value < 0.0 ||
                      !isRecent(airspeed.stamp, time, safety_.airspeed_timeout);
  const double speed = airspeed_assumed_ ? nominal_ : airspeed.value;
  slow_ = exceeds(-speed, -safety_.airspeed_min, slow_, safety_.hysteresis);
  airspeed_ = std::max(speed, kLeastAirspeed);

  const double elapsed = std::clamp(time - last_time_, 0.0, kAssumedWindTime);
  last_time_ = time;
  wind_assumed_ = !wind.value.allFinite() || !isRecent(wind.stamp, time, safety_.wind_timeout);
  if (wind_assumed_) {
    const Eigen::Vector2d air = airspeed_ * Eigen::Vector2d(std::cos(heading), std::sin(heading));
    const Eigen::Vector2d assumed = ground_velocity - air;
    wind_ += elapsed / kAssumedWindTime * (assumed - wind_);
  } else {
    wind_ = wind.value;
  }
  windy_ = exceeds(wind_.norm(), safety_.wind_share_max * airspeed_, windy_, safety_.hysteresis);
}

}  // namespace polyfly
