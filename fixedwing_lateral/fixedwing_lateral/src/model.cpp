#include "fixedwing_lateral/model.hpp"

#include <array>
#include <cassert>
#include <cmath>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

using Index = LateralIndex;

constexpr int kStages = 4;
// Time of each stage, as a share of the step.
constexpr std::array<double, kStages> kStageTime = {0.0, 0.5, 0.5, 1.0};
constexpr std::array<double, kStages> kStageWeight = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};

void checkPositive(double value, const std::string& field) {
  if (!std::isfinite(value) || value <= 0.0)
    throw Error(field + ": must be positive, got " + std::to_string(value));
}

}  // namespace

void checkModel(const LateralModel& model, const std::string& where) {
  checkPositive(model.a0, where + ": a0");
  checkPositive(model.a1, where + ": a1");
  checkPositive(model.b0, where + ": b0");
  if (!std::isfinite(model.roll_rate_max) || model.roll_rate_max < 0.0)
    throw Error(where + ": roll_rate_max: must be at least 0, got " + std::to_string(model.roll_rate_max));
}

Eigen::Vector2d groundVelocity(const LateralConditions& conditions, double heading) noexcept {
  return conditions.airspeed * Eigen::Vector2d(std::cos(heading), std::sin(heading)) + conditions.wind;
}

double rollOfTurn(double curvature, double ground_speed, double crab_cosine,
                  const LateralConditions& conditions) noexcept {
  const double turning = ground_speed * ground_speed * curvature / crab_cosine;
  return std::atan((turning - conditions.airspeed * conditions.turn_bias) /
                   (kGravity * conditions.turn_gain));
}

bool hasSwitched(const LateralState& state) noexcept { return state[Index::kSwitch] > kSwitchThreshold; }

LateralState lateralRate(const LateralModel& model, const LateralConditions& conditions,
                         const LateralState& state, double roll_reference) noexcept {
  assert(conditions.airspeed > 0.0);
  const Eigen::Vector2d velocity = groundVelocity(conditions, state[Index::kHeading]);
  const bool switching = hasSwitched(state) || conditions.gate.isMet(state.head<2>(), velocity);
  LateralState rate;
  rate[Index::kNorth] = velocity.x();
  rate[Index::kEast] = velocity.y();
  rate[Index::kRoll] = state[Index::kRollRate];
  rate[Index::kHeading] =
      conditions.turn_gain * kGravity * std::tan(state[Index::kRoll]) / conditions.airspeed +
      conditions.turn_bias;
  rate[Index::kRollRate] = model.b0 * (roll_reference + conditions.roll_bias) -
                           model.a1 * state[Index::kRollRate] - model.a0 * state[Index::kRoll];
  rate[Index::kSwitch] = switching ? kSwitchRate : 0.0;
  return rate;
}

LateralState integrate(const LateralModel& model, const LateralConditions& conditions,
                       const LateralState& state, const LateralStep& step) noexcept {
  LateralState rate = LateralState::Zero();
  LateralState sum = LateralState::Zero();
  for (int stage = 0; stage < kStages; ++stage) {
    const LateralState looked_at = state + kStageTime[stage] * step.duration * rate;
    rate = lateralRate(model, conditions, looked_at, step.roll_reference);
    sum += kStageWeight[stage] * rate;
  }
  return state + step.duration * sum;
}

}  // namespace polyfly
