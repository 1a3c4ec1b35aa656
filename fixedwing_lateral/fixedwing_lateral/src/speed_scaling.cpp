#include "fixedwing_lateral/speed_scaling.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

// Greatest product of the step and the roll loop's natural frequency; the Runge-Kutta step is accurate below it.
constexpr double kStepFrequency = 1.5;
// Least ratio of the weights of e_t and phi_r [rad^2/m^2].
constexpr double kLeastStiffness = 1e-9;
// Share of the unseen part of a turn by which a corner is switched before its bisector.
constexpr double kLeadShare = 0.5;
// Exponent of the full weight's fall with the error.
constexpr double kFall = 4.0 / 3.0;

}  // namespace

SpeedScaling scalingAt(double airspeed, const LateralWeights& weights, const HorizonOptions& horizon,
                       const LateralModel& model) noexcept {
  SpeedScaling scaling;
  if (weights.airspeed > 0.0) scaling.scale = std::max(1.0, airspeed / weights.airspeed);
  const double longest = std::max(horizon.step, kStepFrequency / std::sqrt(model.a0));
  scaling.step = std::min(horizon.step * scaling.scale, longest);
  // (w_published / w)^3, w being the frequency near the path.
  const LateralWeights published;
  const double stiffness = weights.track / weights.roll_reference;
  const double slowness =
      std::pow(published.track / published.roll_reference / std::max(stiffness, kLeastStiffness), 0.75);
  scaling.near = kNearTime * airspeed * std::min(1.0, slowness);
  return scaling;
}

LateralWeights scaledWeights(const LateralWeights& weights, const SpeedScaling& scaling,
                             double largest_error) noexcept {
  if (!(scaling.scale > 1.0)) return weights;
  const double squared = scaling.scale * scaling.scale;
  const double allowed = std::pow(scaling.near / std::max(largest_error, scaling.near), kFall);
  LateralWeights scaled = weights;
  scaled.track *= std::max(allowed, 1.0 / (squared * squared));
  scaled.roll_rate *= squared;
  return scaled;
}

CornerShape cornerShapeOf(const SwitchGate& gate, const CornerConditions& conditions, double scaled_airspeed,
                          const LateralModel& model) noexcept {
  CornerShape shape;
  const double acceleration = kGravity * std::tan(conditions.roll);  // in the steepest turn
  const double speed = std::max(0.0, conditions.airspeed + gate.cornerDirection().dot(conditions.wind));
  const double greatest = conditions.airspeed + conditions.wind.norm();
  if (scaled_airspeed > 0.0) {
    const double most = std::max(1.0, greatest / scaled_airspeed);
    shape.radius_scale = most * most;
    const double fastest = gate.isBisected() ? speed : std::max(speed, conditions.airspeed);
    const double here = std::max(1.0, fastest / scaled_airspeed);
    shape.published_scale = here * here;
  }
  const double unseen =
      speed * speed / acceleration * gate.cornerAngle() + speed * (model.a1 / model.a0 - conditions.horizon);
  shape.lead = kLeadShare * std::max(0.0, unseen);
  return shape;
}

}  // namespace polyfly
