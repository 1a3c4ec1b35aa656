#include "fixedwing_lateral/tracking_cost.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {

using Index = LateralIndex;

namespace {

// Least cosine of the angle between course and heading.
constexpr double kLeastCrabCosine = 0.2;

}  // namespace

const PathSegment& TrackingCost::segmentOf(const LateralState& state) const noexcept {
  return segmentAt(state, groundVelocity(data_.conditions, state[Index::kHeading]));
}

const PathSegment& TrackingCost::segmentAt(const LateralState& state,
                                           const Eigen::Vector2d& velocity) const noexcept {
  const SwitchGate& gate = data_.conditions.gate;
  const Eigen::Vector2d position = state.head<2>();
  const bool switched =
      hasSwitched(state) || (!gate.isOutOfReach(position, 0.0) && gate.isMet(position, velocity));
  return switched ? data_.next : data_.current;
}

Reversal TrackingCost::reversalOn(const PathSegment& segment) const noexcept {
  return &segment == &data_.next ? data_.next_reversal : data_.reversal;
}

double TrackingCost::trackWeight(Reversal reversal) const noexcept {
  return reversal == Reversal::kNone ? weights_.track : 0.0;
}

// With a course rate of v_g / (distance to the centre of curvature).
double TrackingCost::rollAlong(const ClosestPoint& nearest, double track, const Eigen::Vector2d& air,
                               const Eigen::Vector2d& velocity) const noexcept {
  const LateralConditions& conditions = data_.conditions;
  if (nearest.curvature == 0.0 && conditions.turn_bias == 0.0) return 0.0;
  const double curvature = nearest.curvature / std::max(1.0 - nearest.curvature * track, kLeastCentreShare);
  const double speed = velocity.norm();
  const double crab = speed > kLeastGroundSpeed ? velocity.dot(air) / (speed * conditions.airspeed) : 1.0;
  return rollOfTurn(curvature, speed, std::max(crab, kLeastCrabCosine), conditions);
}

StageTerms TrackingCost::linearise(const LateralState& state, HorizonStage& stage) const noexcept {
  const double heading = state[Index::kHeading];
  const Eigen::Vector2d air =
      data_.conditions.airspeed * Eigen::Vector2d(std::cos(heading), std::sin(heading));
  const Eigen::Vector2d velocity = air + data_.conditions.wind;
  const Eigen::Vector2d position = state.head<2>();
  const PathSegment& segment = segmentAt(state, velocity);
  const ClosestPoint nearest = closestOnCarrier(segment, position);
  TrackErrorJacobian by;
  const TrackError error = trackError(nearest, position, velocity, by);
  const Reversal reversal = reversalOn(segment);
  const double course = courseError(error.course, reversal);
  // Derivatives by n, e and psi.
  const Eigen::Vector3d track(by.track_by_position.x(), by.track_by_position.y(), 0.0);
  const Eigen::Vector3d turn(by.course_by_position.x(), by.course_by_position.y(),
                             by.course_by_velocity.y() * air.x() - by.course_by_velocity.x() * air.y());
  const double w_t = trackWeight(reversal);
  const double w_c = weights_.course;
  const double rate = state[Index::kRollRate];
  stage.Q.topLeftCorner<3, 3>() = w_t * track * track.transpose() + w_c * turn * turn.transpose();
  stage.Q(HorizonStage::kRoll, HorizonStage::kRoll) = weights_.roll;
  stage.Q(HorizonStage::kRollRate, HorizonStage::kRollRate) = weights_.roll_rate;
  stage.q << w_t * error.track * track + w_c * course * turn, 0.0, weights_.roll_rate * rate;
  StageTerms terms;
  terms.track_error = std::abs(error.track);
  terms.cost = w_t * error.track * error.track + w_c * course * course + weights_.roll_rate * rate * rate;
  if (weights_.feedforward > 0.0)
    terms.roll_along = weights_.feedforward * rollAlong(nearest, error.track, air, velocity);
  return terms;
}

}  // namespace polyfly
