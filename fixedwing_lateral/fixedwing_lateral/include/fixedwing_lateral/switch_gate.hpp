#pragma once

#include <Eigen/Core>
#include <string>

#include "fixedwing_lateral/path.hpp"

namespace polyfly {

/// When a segment counts as flown (Eq. 47, Fig. 18).
struct SwitchCriterion {
  /// Radius about the segment's end [m], > 0.
  double acceptance_radius = 35.0;
  /// The acceptance radius where the next segment continues in the same direction, without a corner [m], > 0.
  double smooth_radius = 10.0;
  /// Whether a corner is switched at its bisector, see SwitchGate::bisect. False as published.
  bool at_bisector = false;
};

/// Greatest angle from the segment's direction at its end to the ground velocity, as published [rad].
constexpr double kCourseTolerance = kPi / 4.0;

/// What the speed makes of a corner.
struct CornerShape {
  double radius_scale = 1.0;  ///< factor of the acceptance radius, > 0
  double lead = 0.0;          ///< how far before the bisector it is switched [m], >= 0
  /// The same factor for the condition as published, where the radius decides how early a corner is switched.
  double published_scale = 1.0;
};

/// A corner is sharp from this angle on: the path leads back, and the corner is not bisected [rad].
constexpr double kSharp = 120.0 / 180.0 * kPi;

/// The switch condition of one segment, made ready for the horizon.
///
/// Met where the position lies within the acceptance radius of the segment's end and the ground velocity within the
/// tolerance of the segment's direction there. An arc of most of a circle begins near its own end. So besides, what
/// remains of the segment must not exceed pi/2 times the acceptance radius (half a circle on it as diameter). That
/// holds by itself on lines and on the last half turn of an arc.
class SwitchGate {
 public:
  /// Never met: on the last segment, and on a loiter.
  SwitchGate() = default;

  /// At the end of `segment`, which must pass checkSegment.
  explicit SwitchGate(const PathSegment& segment,
                      double acceptance_radius = SwitchCriterion{}.acceptance_radius);

  /// The next segment begins at this one's end, in the direction `onward` (a unit vector). Then the position must
  /// also lie beyond the line that halves the angle between both segments, where the next one is the nearer. The
  /// course may be any between both directions, with the tolerance. The turn onto both needs more room at a sharper
  /// corner, so the acceptance radius is divided by the cosine of half the angle. A sharp corner is switched as published, on
  /// a radius that fits the speed.
  void bisect(const Eigen::Vector2d& onward) noexcept;

  bool isBisected() const noexcept { return is_corner_ && corner_angle_ < kSharp; }
  /// Of a corner: the direction in which it is flown, and the angle from one segment to the other [rad].
  const Eigen::Vector2d& cornerDirection() const noexcept { return isBisected() ? between_ : end_.tangent; }
  double cornerAngle() const noexcept { return corner_angle_; }

  /// Nothing where bisect was not called.
  void shapeCorner(const CornerShape& shape) noexcept;

  /// False for a NaN, and below kLeastGroundSpeed.
  bool isMet(const Eigen::Vector2d& position, const Eigen::Vector2d& ground_velocity) const noexcept;

  /// The condition as published, also at a corner that is bisected: for a law that does not see corners ahead.
  bool isMetAsPublished(const Eigen::Vector2d& position,
                        const Eigen::Vector2d& ground_velocity) const noexcept;

  /// The condition cannot be met within `distance` [m] of the position, whatever the velocity.
  bool isOutOfReach(const Eigen::Vector2d& position, double distance) const noexcept;

 private:
  double radius() const noexcept { return shape_.radius_scale * widening_ * acceptance_radius_; }
  double publishedRadius() const noexcept { return shape_.published_scale * acceptance_radius_; }

  bool can_open_ = false;
  PathSegment segment_;
  PathPoint end_;
  double acceptance_radius_ = 0.0;  // [m]
  bool is_corner_ = false;
  // Mean direction of both segments at a corner, and the least cosine of the course's angle from it.
  Eigen::Vector2d between_ = Eigen::Vector2d::Zero();
  double least_corner_cosine_ = 0.0;
  double corner_angle_ = 0.0;  // [rad]
  // Factor of the acceptance radius on the bisector.
  double widening_ = 1.0;
  CornerShape shape_;
};

}  // namespace polyfly
