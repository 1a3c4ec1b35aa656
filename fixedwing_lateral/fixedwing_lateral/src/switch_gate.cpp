#include "fixedwing_lateral/switch_gate.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

const double kLeastCourseCosine = std::cos(kCourseTolerance);
// Greatest rest of the segment at a switch, in acceptance radii.
constexpr double kLongestRest = kPi / 2.0;

}  // namespace

SwitchGate::SwitchGate(const PathSegment& segment, double acceptance_radius)
    : can_open_(!std::holds_alternative<LoiterCircle>(segment)),
      segment_(segment),
      acceptance_radius_(acceptance_radius) {
  if (can_open_) end_ = pointAt(segment, length(segment));
}

// The turn of radius R that touches both segments begins at the distance R tan(half) from the corner. It meets the bisector at
// the distance R (1 / cos(half) - 1). An acceptance radius of at least R, divided by cos(half), contains both places.
void SwitchGate::bisect(const Eigen::Vector2d& onward) noexcept {
  if (!can_open_) return;
  is_corner_ = true;
  corner_angle_ = std::acos(std::clamp(end_.tangent.dot(onward), -1.0, 1.0));
  if (!isBisected()) return;
  const double half = 0.5 * corner_angle_;
  between_ = (end_.tangent + onward).normalized();
  widening_ = 1.0 / std::cos(half);
  least_corner_cosine_ = std::cos(std::min(kPi, kCourseTolerance + half));
}

void SwitchGate::shapeCorner(const CornerShape& shape) noexcept {
  if (is_corner_) shape_ = shape;
}

bool SwitchGate::isMet(const Eigen::Vector2d& position,
                       const Eigen::Vector2d& ground_velocity) const noexcept {
  if (!isBisected()) return isMetAsPublished(position, ground_velocity);
  const Eigen::Vector2d beyond = position - end_.position;
  // Written so that a NaN fails each of them.
  if (!(beyond.norm() < radius()) || !(between_.dot(beyond) >= -shape_.lead)) return false;
  const double speed = ground_velocity.norm();
  return speed >= kLeastGroundSpeed && between_.dot(ground_velocity) > least_corner_cosine_ * speed &&
         closestPoint(segment_, position).remaining <= kLongestRest * radius();
}

bool SwitchGate::isMetAsPublished(const Eigen::Vector2d& position,
                                  const Eigen::Vector2d& ground_velocity) const noexcept {
  if (!can_open_) return false;
  // Written so that a NaN fails each of them.
  if (!((position - end_.position).norm() < publishedRadius())) return false;
  const double speed = ground_velocity.norm();
  if (!(speed >= kLeastGroundSpeed)) return false;
  if (!(end_.tangent.dot(ground_velocity) > kLeastCourseCosine * speed)) return false;
  return closestPoint(segment_, position).remaining <= kLongestRest * publishedRadius();
}

bool SwitchGate::isOutOfReach(const Eigen::Vector2d& position, double distance) const noexcept {
  if (!can_open_) return true;
  const double reach = (isBisected() ? radius() : publishedRadius()) + distance;
  return (position - end_.position).squaredNorm() >= reach * reach;
}

}  // namespace polyfly
