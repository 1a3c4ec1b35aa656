#pragma once

#include "fixedwing_lateral/guidance.hpp"
#include "fixedwing_lateral/mission.hpp"

namespace polyfly {

struct L1Options {
  /// Period of the path's oscillation [s], > 0.
  double period = 16.0;
  double damping = 0.75;          ///< [-], > 0
  double roll_limit = 0.6108652;  ///< [rad]
};

/// The roll reference of L1 guidance [rad], within the limit: towards a point of the segment at the distance L1 ahead.
double l1RollReference(const PathSegment& segment, const Eigen::Vector2d& position,
                       const Eigen::Vector2d& ground_velocity, const L1Options& options) noexcept;

/// The least period with which an aircraft can turn onto a path that it crosses at a right angle [s]. Then L1 is the
/// radius of its turn, so period = pi v / (damping g tan(phi)). 8.5 s at 14 m/s with 35 degrees, 31.7 s at 52 m/s.
double leastL1Period(double ground_speed, const L1Options& options) noexcept;

/// The guidance of many autopilots, to compare with (Park, Deyst and How, 2004). It steers towards a point of the
/// path at the distance L1 ahead. The lateral acceleration of the ground velocity is 2 v^2 / L1 sin(eta), with L1 in
/// proportion to the ground speed. It sees one segment and no roll dynamics. Missions as in LateralGuidance, with the
/// published switch condition at each corner; no failsafe policy.
class L1Guidance {
 public:
  L1Guidance(Mission mission, const SwitchCriterion& criterion, const L1Options& options);

  /// `input` must be finite. Allocates nothing.
  GuidanceOutput update(const GuidanceInput& input) noexcept;

  const MissionTrack& track() const noexcept { return track_; }

 private:
  MissionTrack track_;
  L1Options options_;
};

}  // namespace polyfly
