#pragma once

#include <Eigen/Core>

#include "fixedwing_lateral/guidance_options.hpp"

namespace polyfly {

/// A measurement, or none yet.
struct StampedAirspeed {
  double value = 0.0;     ///< [m/s]
  double stamp = -1e300;  ///< [s]
};
struct StampedWind {
  /// Velocity of the air over ground (north, east) [m/s].
  Eigen::Vector2d value = Eigen::Vector2d::Zero();
  double stamp = -1e300;  ///< [s]
};

/// Airspeed and wind that can be flown by, whatever comes in.
class AirData {
 public:
  explicit AirData(const GuidanceOptions& options);

  void setSafety(const SafetyOptions& safety) noexcept { safety_ = safety; }

  /// `ground_velocity` (north, east) [m/s] and `heading` [rad] must be finite; the stamped values may be
  /// anything.
  void update(double time, const StampedAirspeed& airspeed, const StampedWind& wind,
              const Eigen::Vector2d& ground_velocity, double heading) noexcept;

  double airspeed() const noexcept { return airspeed_; }          ///< [m/s], positive
  const Eigen::Vector2d& wind() const noexcept { return wind_; }  ///< [m/s], finite
  bool airspeedAssumed() const noexcept { return airspeed_assumed_; }
  bool windAssumed() const noexcept { return wind_assumed_; }
  /// True while the airspeed is below the least airspeed.
  bool isSlow() const noexcept { return slow_; }
  /// True while the wind speed is near or above the airspeed.
  bool isWindy() const noexcept { return windy_; }

 private:
  SafetyOptions safety_;
  double nominal_ = 0.0;
  double correction_time_ = 0.0;
  double airspeed_ = 0.0;
  Eigen::Vector2d wind_ = Eigen::Vector2d::Zero();
  // Last wind estimate received [m/s].
  Eigen::Vector2d estimate_ = Eigen::Vector2d::Zero();
  // Filtered correction of the wind estimate from the ground velocity [m/s].
  Eigen::Vector2d correction_ = Eigen::Vector2d::Zero();
  double last_time_ = -1e300;
  bool airspeed_assumed_ = true;
  bool wind_assumed_ = true;
  bool slow_ = false;
  bool windy_ = false;
};

}  // namespace polyfly
