#pragma once

#include <Eigen/Core>
#include <string>

#include "fixedwing_lateral/path.hpp"

namespace polyfly {

/// When a segment counts as flown (Eq. 47, Fig. 18).
struct SwitchCriterion {
  /// Radius about the segment's end [m], > 0.
  double acceptance_radius = 35.0;
  /// Greatest angle from the segment's direction at its end to the ground velocity [rad], in (0, pi).
  double course_tolerance = kPi / 4.0;
  /// The acceptance radius where the next segment continues in the same direction, without a corner [m], > 0.
  double smooth_radius = 10.0;
};

/// The switch condition of one segment, made ready for the horizon.
///
/// Met where the position lies within the acceptance radius of the segment's end and the ground velocity
/// within the tolerance of the segment's direction there. An arc of most of a circle begins near its own end;
/// so besides, what remains of the segment must not exceed pi/2 times the acceptance radius (half a circle on
/// it as diameter), which holds by itself on lines and on the last half turn of an arc.
class SwitchGate {
 public:
  /// Never met: on the last segment, and on a loiter.
  SwitchGate() = default;

  /// At the end of `segment`, which must pass checkSegment. Throws polyfly::Error, beginning with `where`, if
  /// the criterion is out of its range.
  SwitchGate(const PathSegment& segment, const SwitchCriterion& criterion, const std::string& where);

  /// False for a NaN, and below kLeastGroundSpeed.
  bool isMet(const Eigen::Vector2d& position, const Eigen::Vector2d& ground_velocity) const noexcept;

  /// The condition cannot be met within `distance` [m] of the position, whatever the velocity.
  bool isOutOfReach(const Eigen::Vector2d& position, double distance) const noexcept;

 private:
  bool can_open_ = false;
  PathSegment segment_;
  PathPoint end_;
  double acceptance_radius_ = 0.0;  // [m]
  // Cosine of the course tolerance.
  double least_course_cosine_ = 0.0;
};

}  // namespace polyfly
