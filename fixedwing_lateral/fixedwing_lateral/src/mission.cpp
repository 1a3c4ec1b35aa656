#include "fixedwing_lateral/mission.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

LoiterCircle loiterAt(const PathPoint& end, const LoiterOptions& options) {
  const double turn = options.direction == TurnDirection::kRight ? 1.0 : -1.0;
  const Eigen::Vector2d inward = turn * Eigen::Vector2d(-end.tangent.y(), end.tangent.x());
  return {end.position + options.radius * inward, options.radius, options.direction};
}

// Greatest distance between the end of a segment and the next one, for a smooth junction [m].
constexpr double kSmoothGap = 1.0;
// Least cosine of the angle between the two directions at a smooth junction.
constexpr double kSmoothCosine = 0.995;

// Radius within which an aircraft is close to an end, in acceptance radii.
constexpr double kNearShare = 2.0;
// Radius beyond which an aircraft has left an end, relative to the radius of kNearShare.
constexpr double kLeftShare = 1.25;
// Number of times that an end is missed before the mission goes on.
constexpr int kMissesMost = 2;

}  // namespace

Onward onwardOf(const PathSegment& segment, const PathSegment& next) {
  const PathPoint end = pointAt(segment, length(segment));
  const ClosestPoint start = closestPoint(next, end.position);
  Onward onward;
  onward.direction = start.point.tangent;
  onward.joins = (start.point.position - end.position).norm() < kSmoothGap &&
                 !(length(next) - start.remaining > kSmoothGap);
  onward.is_smooth = onward.joins && onward.direction.dot(end.tangent) > kSmoothCosine;
  return onward;
}

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
  int merged = 0;
  for (std::size_t i = 1, last = 0; i < points.size(); ++i) {
    if ((points[i] - points[last]).norm() < kSamePoint) {
      ++merged;
      continue;
    }
    segments.emplace_back(LineSegment{points[last], points[i]});
    last = i;
  }
  if (segments.empty()) throw Error(where + ": needs at least two points apart from each other");
  Mission mission = makeMission(std::move(segments), loiter, where);
  mission.merged_points = merged;
  return mission;
}

MissionTrack::MissionTrack(Mission mission, const SwitchCriterion& criterion)
    : mission_(std::move(mission)), near_radius_(kNearShare * criterion.acceptance_radius) {
  const std::vector<PathSegment>& segments = mission_.segments;
  gates_.reserve(segments.size());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    Onward onward;
    if (i + 1 < segments.size()) onward = onwardOf(segments[i], segments[i + 1]);
    gates_.emplace_back(segments[i], onward.is_smooth
                                         ? std::min(criterion.acceptance_radius, criterion.smooth_radius)
                                         : criterion.acceptance_radius);
    if (criterion.at_bisector && onward.joins && !onward.is_smooth) gates_.back().bisect(onward.direction);
    is_next_shown_.push_back(!criterion.at_bisector ||
                             (onward.joins && gates_.back().cornerAngle() < kSharp));
  }
}

bool MissionTrack::advance(const Eigen::Vector2d& position, const Eigen::Vector2d& ground_velocity,
                           bool as_published) noexcept {
  if (empty() || isLoitering()) return false;
  // Each is asked: they remember.
  const bool passed = hasPassedEnd(position);
  const bool missed = hasMissedEnd(position);
  const bool met = as_published ? gate().isMetAsPublished(position, ground_velocity)
                                : gate().isMet(position, ground_velocity);
  if (!met && !passed && !missed) return false;
  ++index_;
  near_end_ = close_to_end_ = false;
  misses_ = 0;
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

// Of a segment that comes by its own end more than once only the rest counts.
bool MissionTrack::hasMissedEnd(const Eigen::Vector2d& position) noexcept {
  const double distance = (position - pointAt(current(), length(current())).position).norm();
  if (!std::isfinite(distance)) return false;
  const double near_radius = near_scale_ * near_radius_;
  if (distance > kLeftShare * near_radius) {
    misses_ += close_to_end_ ? 1 : 0;
    close_to_end_ = false;
  } else if (distance < near_radius &&
             closestPoint(current(), position).remaining < kPi / 2.0 * near_radius) {
    close_to_end_ = true;
  }
  return misses_ >= kMissesMost;
}

}  // namespace polyfly
