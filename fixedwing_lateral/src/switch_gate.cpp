#include "fixedwing_lateral/switch_gate.hpp"

#include <cmath>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Greatest rest of the segment at a switch, in acceptance radii.
constexpr double kLongestRest = kPi / 2.0;

}  // namespace

SwitchGate::SwitchGate(const PathSegment& segment, const SwitchCriterion& criterion, const std::string& where)
    : can_open_(!std::holds_alternative<LoiterCircle>(segment)),
      segment_(segment),
      acceptance_radius_(criterion.acceptance_radius),
      least_course_cosine_(std::cos(criterion.course_tolerance)) {
  if (!std::isfinite(criterion.acceptance_radius) || criterion.acceptance_radius <= 0.0)
    throw Error(where + ": acceptance_radius: must be positive, got " +
                std::to_string(criterion.acceptance_radius));
  if (!(criterion.course_tolerance > 0.0 && criterion.course_tolerance < kPi))
    throw Error(where + ": course_tolerance: must lie between 0 and pi, got " +
                std::to_string(criterion.course_tolerance));
  if (can_open_) end_ = pointAt(segment, length(segment));
}

bool SwitchGate::isMet(const Eigen::Vector2d& position,
                       const Eigen::Vector2d& ground_velocity) const noexcept {
  if (!can_open_) return false;
  // Written so that a NaN fails each of them.
  if (!((position - end_.position).norm() < acceptance_radius_)) return false;
  const double speed = ground_velocity.norm();
  if (!(speed >= kLeastGroundSpeed)) return false;
  if (!(end_.tangent.dot(ground_velocity) > least_course_cosine_ * speed)) return false;
  return closestPoint(segment_, position).remaining <= kLongestRest * acceptance_radius_;
}

bool SwitchGate::isOutOfReach(const Eigen::Vector2d& position, double distance) const noexcept {
  if (!can_open_) return true;
  const double reach = acceptance_radius_ + distance;
  return (position - end_.position).squaredNorm() >= reach * reach;
}

}  // namespace polyfly
