#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <variant>

namespace polyfly {

// Paths in the plane. A point is (north, east) [m]; angles are clockwise from north [rad], as a compass
// counts: heading, course, bearing. Nothing here allocates, and only the checks throw.

/// The numbers are the chapter's `dir`.
enum class TurnDirection : std::int8_t { kLeft = -1, kRight = 1 };

/// From a to b, at least kShortestSegment apart.
struct LineSegment {
  Eigen::Vector2d a = Eigen::Vector2d::Zero();  ///< [m]
  Eigen::Vector2d b = Eigen::Vector2d::Zero();  ///< [m]
};

/// Part of a circle, less than the whole of it.
struct ArcSegment {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< c [m]
  double radius = 0.0;                               ///< R [m], > 0
  TurnDirection direction = TurnDirection::kRight;   ///< dir
  double start_bearing = 0.0;                        ///< psi_0, from the centre to the entrance point [rad]
  double sweep = 0.0;                                ///< delta psi, in (0, 2 pi) for either direction [rad]
};

/// A circle that is flown for ever.
struct LoiterCircle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< [m]
  double radius = 0.0;                               ///< [m], > 0
  TurnDirection direction = TurnDirection::kRight;
};

constexpr double kPi = 3.14159265358979323846;
/// Less than this is no segment: at 10 km from the origin a double resolves 2e-12 m [m].
constexpr double kShortestSegment = 1e-10;
/// Slower than this over ground there is no course [m/s].
constexpr double kLeastGroundSpeed = 1e-2;
/// Nearer than this to the centre of a circle there is no nearest point on it [m].
constexpr double kLeastCentreDistance = 1e-9;

/// A place on a path and the unit vector in which the path is flown there.
struct PathPoint {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< [m]
  Eigen::Vector2d tangent = Eigen::Vector2d::UnitX();
};

/// Where the foot of the perpendicular falls. Off the segment, the nearest point is one of its ends.
enum class Foot : std::uint8_t { kOnSegment, kBeforeStart, kPastEnd };

struct ClosestPoint {
  PathPoint point;
  Foot foot = Foot::kOnSegment;
  double remaining = 0.0;  ///< along the path, from the point to the segment's end; infinite on a loiter [m]
  double curvature = 0.0;  ///< there, positive where the path turns right; 0 off the ends [1/m]
};

/// Any other path that can tell its nearest point, the tangent and the curvature there. Its functions are
/// called in the control step: they must not allocate.
class PathCurve {
 public:
  virtual ~PathCurve() = default;
  /// Off the ends the nearer end, with curvature 0.
  virtual ClosestPoint closest(const Eigen::Vector2d& position) const noexcept = 0;
  virtual double length() const noexcept = 0;  ///< [m], > 0
  /// The point at `distance` from the start, which must be within the length [m].
  virtual PathPoint pointAt(double distance) const noexcept = 0;
};

/// A curve that somebody else owns, for as long as the segment is used.
struct CurveSegment {
  const PathCurve* curve = nullptr;
};

using PathSegment = std::variant<LineSegment, ArcSegment, LoiterCircle, CurveSegment>;

struct TrackError {
  double track = 0.0;           ///< e_t of Eq. 48 [m], positive to the right of the path
  double course = 0.0;          ///< e_chi of Eq. 49 [rad] in [-pi, pi), positive where the path bears right
  bool course_defined = false;  ///< false below kLeastGroundSpeed; e_chi is 0 then
};

/// Derivatives of a TrackError. Those by the position hold for any path. A foot that moves along the path turns the
/// tangent, but does not change the distance to first order.
struct TrackErrorJacobian {
  Eigen::Vector2d track_by_position = Eigen::Vector2d::Zero();   ///< [-]
  Eigen::Vector2d course_by_position = Eigen::Vector2d::Zero();  ///< [rad/m]
  Eigen::Vector2d course_by_velocity = Eigen::Vector2d::Zero();  ///< [rad s/m], ground velocity
};

/// Nearer to the centre of curvature than this share of the radius, the course of the foot turns fast. Its derivative
/// then says nothing of the next metre. So it is limited to its value at this share.
constexpr double kLeastCentreShare = 0.1;

/// The same angle in [-pi, pi).
double wrapCourse(double angle) noexcept;

/// Throws polyfly::Error, beginning with `where`, if the segment breaks a rule stated above.
void checkSegment(const PathSegment& segment, const std::string& where);

/// The segment's nearest point. Off the sweep of an arc, its nearer end is the nearest point. So e_t continues as the
/// distance from the tangent there. It steps only in two places. Midway between the ends, the end wins a tie. At the
/// centre, the entrance point stands in for all. A loiter has no ends; in its centre the point north of it stands in.
ClosestPoint closestPoint(const PathSegment& segment, const Eigen::Vector2d& position) noexcept;

/// The nearest point of the line or circle that the segment is part of, as if it had no ends. e_t and e_chi are
/// smooth past them, as an optimisation needs. `remaining` is infinite.
ClosestPoint closestOnCarrier(const PathSegment& segment, const Eigen::Vector2d& position) noexcept;

/// Eq. 48 and 49 for any path that can tell its nearest point and the tangent there.
TrackError trackError(const PathPoint& nearest, const Eigen::Vector2d& position,
                      const Eigen::Vector2d& ground_velocity) noexcept;

/// The same with its derivatives.
TrackError trackError(const ClosestPoint& nearest, const Eigen::Vector2d& position,
                      const Eigen::Vector2d& ground_velocity, TrackErrorJacobian& jacobian) noexcept;

/// [m]; infinite for a loiter.
double length(const PathSegment& segment) noexcept;

/// The point at `distance` [m] from the start, which is limited to the segment. A loiter starts north of its
/// centre and goes round and round.
PathPoint pointAt(const PathSegment& segment, double distance) noexcept;

}  // namespace polyfly
