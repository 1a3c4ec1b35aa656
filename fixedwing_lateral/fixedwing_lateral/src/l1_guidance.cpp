#include "fixedwing_lateral/l1_guidance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fixedwing_lateral/model.hpp"

namespace polyfly {
namespace {

constexpr double kLeastDistance = 5.0;  // L1 [m]
constexpr double kLeastSpeed = 1.0;     // [m/s]

/// The point `ahead` along the line or circle of the segment.
Eigen::Vector2d pointAhead(const ClosestPoint& nearest, double ahead) noexcept {
  const Eigen::Vector2d& tangent = nearest.point.tangent;
  const Eigen::Vector2d right(-tangent.y(), tangent.x());
  if (nearest.curvature == 0.0) return nearest.point.position + ahead * tangent;
  const double angle = std::clamp(nearest.curvature * ahead, -kPi / 2.0, kPi / 2.0);
  const double radius = 1.0 / nearest.curvature;  // signed
  return nearest.point.position + radius * (std::sin(angle) * tangent + (1.0 - std::cos(angle)) * right);
}

}  // namespace

double l1RollReference(const PathSegment& segment, const Eigen::Vector2d& position,
                       const Eigen::Vector2d& ground_velocity, const L1Options& options) noexcept {
  const double speed = std::max(ground_velocity.norm(), kLeastSpeed);
  const double distance = std::max(options.period * options.damping / kPi * speed, kLeastDistance);
  const ClosestPoint nearest = closestOnCarrier(segment, position);
  const double off = std::min((nearest.point.position - position).norm(), distance);
  const Eigen::Vector2d aim = pointAhead(nearest, std::sqrt(distance * distance - off * off)) - position;
  const double eta = std::clamp(
      wrapCourse(std::atan2(aim.y(), aim.x()) - std::atan2(ground_velocity.y(), ground_velocity.x())),
      -kPi / 2.0, kPi / 2.0);
  const double acceleration = 2.0 * speed * speed / distance * std::sin(eta);
  return std::clamp(std::atan(acceleration / kGravity), -options.roll_limit, options.roll_limit);
}

double leastL1Period(double ground_speed, const L1Options& options) noexcept {
  return kPi * ground_speed / (options.damping * kGravity * std::tan(options.roll_limit));
}

L1Guidance::L1Guidance(Mission mission, const SwitchCriterion& criterion, const L1Options& options)
    : track_(std::move(mission), criterion), options_(options) {}

GuidanceOutput L1Guidance::update(const GuidanceInput& input) noexcept {
  const Eigen::Vector2d& position = input.state.position;
  const Eigen::Vector2d& velocity = input.state.ground_velocity;
  track_.advance(position, velocity, true);
  GuidanceOutput output;
  output.mode = GuidanceMode::kTracking;
  output.reason = GuidanceReason::kNone;
  output.segment = track_.index();
  output.segment_count = track_.count();
  output.loitering = track_.isLoitering();
  output.error = trackError(closestPoint(track_.current(), position).point, position, velocity);

  output.roll_reference = l1RollReference(track_.current(), position, velocity, options_);
  return output;
}

}  // namespace polyfly
