#include "fixedwing_lateral/mission.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "region_maps/error.hpp"

namespace polyfly {
namespace {

LoiterCircle loiterAt(const PathPoint& end, const LoiterOptions& options) {
  const double turn = options.direction == TurnDirection::kRight ? 1.0 : -1.0;
  const Eigen::Vector2d inward = turn * Eigen::Vector2d(-end.tangent.y(), end.tangent.x());
  return {end.position + options.radius * inward, options.radius, options.direction};
}

constexpr double kSmoothGap = 1.0;       // between an end and the next segment, at most [m]
constexpr double kSmoothCosine = 0.995;  // of the angle between their directions, at least

/// Of the segment [1/m], without its sign.
double largestCurvature(const PathSegment& segment) {
  if (std::holds_alternative<LineSegment>(segment)) return 0.0;
  if (const auto* arc = std::get_if<ArcSegment>(&segment)) return 1.0 / arc->radius;
  if (const auto* circle = std::get_if<LoiterCircle>(&segment)) return 1.0 / circle->radius;
  constexpr int kPoints = 500;
  double largest = 0.0;
  for (int i = 0; i <= kPoints; ++i) {
    const PathPoint point = pointAt(segment, length(segment) * i / kPoints);
    largest = std::max(largest, std::abs(closestPoint(segment, point.position).curvature));
  }
  return largest;
}

constexpr double kGravity = 9.81;

/// The next segment goes on where this one ends, in the same direction.
bool isSmooth(const PathSegment& segment, const PathSegment& next) {
  const PathPoint end = pointAt(segment, length(segment));
  const ClosestPoint onward = closestPoint(next, end.position);
  return (onward.point.position - end.position).norm() < kSmoothGap &&
         onward.point.tangent.dot(end.tangent) > kSmoothCosine &&
         !(length(next) - onward.remaining > kSmoothGap);  // it begins there
}

}  // namespace

Mission makeMission(std::vector<PathSegment> segments, const LoiterOptions& loiter,
                    const std::string& where) {
  if (segments.empty()) throw Error(where + ": needs at least one segment");
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const std::string name = where + ": segment " + std::to_string(i);
    checkSegment(segments[i], name);
    if (std::holds_alternative<LoiterCircle>(segments[i]) && i + 1 < segments.size())
      throw Error(name + ": a loiter has no end, so it must be the last");
  }
  if (!std::holds_alternative<LoiterCircle>(segments.back())) {
    const PathSegment end = loiterAt(pointAt(segments.back(), length(segments.back())), loiter);
    checkSegment(end, where + ": loiter");
    segments.push_back(end);
  }
  return {std::move(segments), {}};
}

Mission missionThrough(const std::vector<Eigen::Vector2d>& points, const LoiterOptions& loiter,
                       const std::string& where) {
  std::vector<PathSegment> segments;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if ((points[i] - points[i - 1]).norm() < kShortestSegment) continue;
    segments.emplace_back(LineSegment{points[i - 1], points[i]});
  }
  if (segments.empty()) throw Error(where + ": needs at least two points apart from each other");
  return makeMission(std::move(segments), loiter, where);
}

// psi' = chi' v_g / (V cos(crab)) with chi' = v_g curvature: tan(phi) = v_g^2 curvature / (g cos(crab)).
double steepestRoll(const PathSegment& segment, double airspeed, double wind_speed) {
  const double curvature = largestCurvature(segment);
  if (curvature == 0.0) return 0.0;
  if (!(wind_speed < airspeed)) return kPi / 2.0;
  constexpr int kDirections = 180;
  double steepest = 0.0;
  for (int i = 0; i <= kDirections; ++i) {
    const double angle = kPi * i / kDirections;  // of the wind against the course
    const double sine = wind_speed * std::sin(angle) / airspeed;
    const double cosine = std::sqrt(1.0 - sine * sine);
    const double speed = airspeed * cosine + wind_speed * std::cos(angle);
    steepest = std::max(steepest, speed * speed / cosine);
  }
  return std::atan(steepest * curvature / kGravity);
}

MissionTrack::MissionTrack(Mission mission, const SwitchCriterion& criterion, const std::string& where)
    : mission_(std::move(mission)) {
  gates_.reserve(mission_.segments.size());
  for (std::size_t i = 0; i < mission_.segments.size(); ++i) {
    SwitchCriterion here = criterion;
    const bool last = i + 1 == mission_.segments.size();
    if (!last && isSmooth(mission_.segments[i], mission_.segments[i + 1]))
      here.acceptance_radius = std::min(criterion.acceptance_radius, criterion.smooth_radius);
    gates_.emplace_back(mission_.segments[i], here, where);
  }
}

bool MissionTrack::advance(const Eigen::Vector2d& position, const Eigen::Vector2d& ground_velocity) noexcept {
  if (empty() || isLoitering()) return false;
  if (!gate().isMet(position, ground_velocity) && !hasPassedEnd(position)) return false;
  ++index_;
  near_end_ = false;
  return true;
}

// A line that lies behind is never met again. A circle comes round again, so of an arc only an end that was
// passed while it was flown counts.
bool MissionTrack::hasPassedEnd(const Eigen::Vector2d& position) noexcept {
  const ClosestPoint nearest = closestPoint(current(), position);
  if (nearest.foot == Foot::kPastEnd && (near_end_ || std::holds_alternative<LineSegment>(current())))
    return true;
  near_end_ = nearest.foot == Foot::kOnSegment && nearest.remaining < 0.5 * length(current());
  return false;
}

}  // namespace polyfly
