#include "fixedwing_lateral/path.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kTurn = 2.0 * kPi;

double sign(TurnDirection direction) noexcept { return direction == TurnDirection::kRight ? 1.0 : -1.0; }

/// In [0, 2 pi]; the upper end by rounding only.
double wrapPositive(double angle) noexcept {
  const double rest = std::fmod(angle, kTurn);
  return rest < 0.0 ? rest + kTurn : rest;
}

double bearingOf(const Eigen::Vector2d& vector) noexcept { return std::atan2(vector.y(), vector.x()); }

PathPoint pointOnCircle(const Eigen::Vector2d& centre, double radius, TurnDirection direction,
                        double bearing) noexcept {
  const Eigen::Vector2d outward(std::cos(bearing), std::sin(bearing));
  // Clockwise the tangent is 90 degrees to the right of the way out.
  return {centre + radius * outward, sign(direction) * Eigen::Vector2d(-outward.y(), outward.x())};
}

ClosestPoint closest(const LineSegment& line, const Eigen::Vector2d& position) noexcept {
  const Eigen::Vector2d along = line.b - line.a;
  const double line_length = along.norm();
  assert(line_length > 0.0);
  const Eigen::Vector2d tangent = along / line_length;
  const double progress = tangent.dot(position - line.a);
  if (progress < 0.0) return {{line.a, tangent}, Foot::kBeforeStart, line_length, 0.0};
  if (progress > line_length) return {{line.b, tangent}, Foot::kPastEnd, 0.0, 0.0};
  return {{line.a + progress * tangent, tangent}, Foot::kOnSegment, line_length - progress, 0.0};
}

ClosestPoint closest(const ArcSegment& arc, const Eigen::Vector2d& position) noexcept {
  assert(arc.radius > 0.0);
  const Eigen::Vector2d out = position - arc.centre;
  const double turn = sign(arc.direction);
  const bool at_centre = out.norm() < kLeastCentreDistance;
  double progress = at_centre ? 0.0 : wrapPositive(turn * (bearingOf(out) - arc.start_bearing));
  Foot foot = Foot::kOnSegment;
  if (progress > arc.sweep) {
    const bool end_is_nearer = progress - arc.sweep <= kTurn - progress;
    foot = end_is_nearer ? Foot::kPastEnd : Foot::kBeforeStart;
    progress = end_is_nearer ? arc.sweep : 0.0;
  }
  return {pointOnCircle(arc.centre, arc.radius, arc.direction, arc.start_bearing + turn * progress), foot,
          arc.radius * (arc.sweep - progress), foot == Foot::kOnSegment ? turn / arc.radius : 0.0};
}

ClosestPoint closest(const CurveSegment& segment, const Eigen::Vector2d& position) noexcept {
  return segment.curve->closest(position);
}

constexpr double kEndless = std::numeric_limits<double>::infinity();

ClosestPoint closestOnCircle(const Eigen::Vector2d& centre, double radius, TurnDirection direction,
                             double start_bearing, const Eigen::Vector2d& position) noexcept {
  const Eigen::Vector2d out = position - centre;
  const double distance = out.norm();
  const double turn = sign(direction);
  if (distance < kLeastCentreDistance)
    return {pointOnCircle(centre, radius, direction, start_bearing), Foot::kOnSegment, kEndless,
            turn / radius};
  const Eigen::Vector2d outward = out / distance;
  return {{centre + radius * outward, turn * Eigen::Vector2d(-outward.y(), outward.x())},
          Foot::kOnSegment,
          kEndless,
          turn / radius};
}

ClosestPoint carrier(const LineSegment& line, const Eigen::Vector2d& position) noexcept {
  const Eigen::Vector2d tangent = (line.b - line.a).normalized();
  return {{line.a + tangent.dot(position - line.a) * tangent, tangent}, Foot::kOnSegment, kEndless, 0.0};
}

ClosestPoint carrier(const ArcSegment& arc, const Eigen::Vector2d& position) noexcept {
  return closestOnCircle(arc.centre, arc.radius, arc.direction, arc.start_bearing, position);
}

ClosestPoint carrier(const LoiterCircle& loiter, const Eigen::Vector2d& position) noexcept {
  return closestOnCircle(loiter.centre, loiter.radius, loiter.direction, 0.0, position);
}

ClosestPoint carrier(const CurveSegment& segment, const Eigen::Vector2d& position) noexcept {
  return segment.curve->closest(position);
}

ClosestPoint closest(const LoiterCircle& loiter, const Eigen::Vector2d& position) noexcept {
  return carrier(loiter, position);
}

void checkPoint(const Eigen::Vector2d& point, const std::string& field) {
  if (!point.allFinite()) throw Error(field + ": must be finite");
}

void checkRadius(double radius, const std::string& field) {
  if (!std::isfinite(radius) || radius <= 0.0)
    throw Error(field + ": must be positive, got " + std::to_string(radius));
}

void checkDirection(TurnDirection direction, const std::string& field) {
  if (direction != TurnDirection::kLeft && direction != TurnDirection::kRight)
    throw Error(field + ": must be -1 (left) or 1 (right), got " +
                std::to_string(static_cast<int>(direction)));
}

void checkArcLength(const ArcSegment& arc, const std::string& where) {
  if (!std::isfinite(arc.start_bearing)) throw Error(where + ": start_bearing: must be finite");
  if (!(arc.sweep > 0.0 && arc.sweep < kTurn))
    throw Error(where + ": sweep: must lie between 0 and 2 pi, got " + std::to_string(arc.sweep));
  if (arc.radius * arc.sweep < kShortestSegment) throw Error(where + ": sweep: the arc has no length");
}

}  // namespace

double wrapCourse(double angle) noexcept {
  const double wrapped = std::remainder(angle, kTurn);
  return wrapped >= kPi ? wrapped - kTurn : wrapped;
}

void checkSegment(const PathSegment& segment, const std::string& where) {
  if (const auto* line = std::get_if<LineSegment>(&segment)) {
    checkPoint(line->a, where + ": a");
    checkPoint(line->b, where + ": b");
    if ((line->b - line->a).norm() < kShortestSegment) throw Error(where + ": b: must differ from a");
  } else if (const auto* arc = std::get_if<ArcSegment>(&segment)) {
    checkPoint(arc->centre, where + ": centre");
    checkRadius(arc->radius, where + ": radius");
    checkDirection(arc->direction, where + ": direction");
    checkArcLength(*arc, where);
  } else if (const auto* loiter = std::get_if<LoiterCircle>(&segment)) {
    checkPoint(loiter->centre, where + ": centre");
    checkRadius(loiter->radius, where + ": radius");
    checkDirection(loiter->direction, where + ": direction");
  } else if (const auto* segment_of = std::get_if<CurveSegment>(&segment)) {
    if (segment_of->curve == nullptr) throw Error(where + ": curve: missing");
  }
}

ClosestPoint closestPoint(const PathSegment& segment, const Eigen::Vector2d& position) noexcept {
  return std::visit([&](const auto& kind) { return closest(kind, position); }, segment);
}

ClosestPoint closestOnCarrier(const PathSegment& segment, const Eigen::Vector2d& position) noexcept {
  return std::visit([&](const auto& kind) { return carrier(kind, position); }, segment);
}

TrackError trackError(const PathPoint& nearest, const Eigen::Vector2d& position,
                      const Eigen::Vector2d& ground_velocity) noexcept {
  TrackErrorJacobian unused;
  return trackError({nearest}, position, ground_velocity, unused);
}

TrackError trackError(const ClosestPoint& nearest, const Eigen::Vector2d& position,
                      const Eigen::Vector2d& ground_velocity, TrackErrorJacobian& jacobian) noexcept {
  const Eigen::Vector2d& tangent = nearest.point.tangent;
  const Eigen::Vector2d to_path = nearest.point.position - position;
  TrackError error;
  error.track = to_path.x() * tangent.y() - to_path.y() * tangent.x();
  jacobian.track_by_position = {-tangent.y(), tangent.x()};
  // Distance from the centre of curvature, as a share of the radius.
  const double share = 1.0 - nearest.curvature * error.track;
  jacobian.course_by_position = nearest.curvature / std::max(share, kLeastCentreShare) * tangent;
  const double speed_squared = ground_velocity.squaredNorm();
  error.course_defined = speed_squared >= kLeastGroundSpeed * kLeastGroundSpeed;
  if (!error.course_defined) {
    jacobian.course_by_velocity.setZero();
    jacobian.course_by_position.setZero();
    return error;
  }
  const double along = ground_velocity.dot(tangent);
  const double across = ground_velocity.x() * tangent.y() - ground_velocity.y() * tangent.x();
  const double course = std::atan2(across, along);
  error.course = course >= kPi ? -kPi : course;
  jacobian.course_by_velocity = Eigen::Vector2d(ground_velocity.y(), -ground_velocity.x()) / speed_squared;
  return error;
}

double length(const PathSegment& segment) noexcept {
  if (const auto* line = std::get_if<LineSegment>(&segment)) return (line->b - line->a).norm();
  if (const auto* arc = std::get_if<ArcSegment>(&segment)) return arc->radius * arc->sweep;
  if (const auto* curve = std::get_if<CurveSegment>(&segment)) return curve->curve->length();
  return std::numeric_limits<double>::infinity();
}

PathPoint pointAt(const PathSegment& segment, double distance) noexcept {
  const double along = std::clamp(distance, 0.0, length(segment));
  if (const auto* line = std::get_if<LineSegment>(&segment)) {
    const Eigen::Vector2d tangent = (line->b - line->a).normalized();
    return {line->a + along * tangent, tangent};
  }
  if (const auto* arc = std::get_if<ArcSegment>(&segment)) {
    const double bearing = arc->start_bearing + sign(arc->direction) * along / arc->radius;
    return pointOnCircle(arc->centre, arc->radius, arc->direction, bearing);
  }
  if (const auto* curve = std::get_if<CurveSegment>(&segment)) return curve->curve->pointAt(along);
  const auto& loiter = *std::get_if<LoiterCircle>(&segment);
  return pointOnCircle(loiter.centre, loiter.radius, loiter.direction,
                       sign(loiter.direction) * along / loiter.radius);
}

}  // namespace polyfly
