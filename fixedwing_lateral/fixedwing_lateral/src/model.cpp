#include "fixedwing_lateral/model.hpp"

#include <array>
#include <cassert>
#include <cmath>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

using Index = LateralIndex;

// Derivatives by the state and, in the last column, by the roll reference.
constexpr int kInputColumn = Index::kSize;
using Sensitivity = Eigen::Matrix<double, Index::kSize, Index::kSize + 1>;

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
  checkPositive(model.gravity, where + ": gravity");
  if (!std::isfinite(model.roll_rate_max) || model.roll_rate_max < 0.0)
    throw Error(where + ": roll_rate_max: must be at least 0, got " + std::to_string(model.roll_rate_max));
  checkPositive(model.switch_rate, where + ": switch_rate");
  checkPositive(model.switch_threshold, where + ": switch_threshold");
}

Eigen::Vector2d groundVelocity(const LateralConditions& conditions, double heading) noexcept {
  return conditions.airspeed * Eigen::Vector2d(std::cos(heading), std::sin(heading)) + conditions.wind;
}

double rollOfTurn(double curvature, double ground_speed, double crab_cosine,
                  const LateralConditions& conditions, double gravity) noexcept {
  const double turning = ground_speed * ground_speed * curvature / crab_cosine;
  return std::atan((turning - conditions.airspeed * conditions.turn_bias) / (gravity * conditions.turn_gain));
}

bool hasSwitched(const LateralModel& model, const LateralState& state) noexcept {
  return state[Index::kSwitch] > model.switch_threshold;
}

LateralState lateralRate(const LateralModel& model, const LateralConditions& conditions,
                         const LateralState& state, double roll_reference) noexcept {
  assert(conditions.airspeed > 0.0);
  const Eigen::Vector2d velocity = groundVelocity(conditions, state[Index::kHeading]);
  const bool switching = hasSwitched(model, state) || conditions.gate.isMet(state.head<2>(), velocity);
  LateralState rate;
  rate[Index::kNorth] = velocity.x();
  rate[Index::kEast] = velocity.y();
  rate[Index::kRoll] = state[Index::kRollRate];
  rate[Index::kHeading] =
      conditions.turn_gain * model.gravity * std::tan(state[Index::kRoll]) / conditions.airspeed +
      conditions.turn_bias;
  rate[Index::kRollRate] = model.b0 * (roll_reference + conditions.roll_bias) -
                           model.a1 * state[Index::kRollRate] - model.a0 * state[Index::kRoll];
  rate[Index::kSwitch] = switching ? model.switch_rate : 0.0;
  return rate;
}

LateralJacobian lateralRateJacobian(const LateralModel& model, const LateralConditions& conditions,
                                    const LateralState& state) noexcept {
  const double cos_roll = std::cos(state[Index::kRoll]);
  LateralJacobian jacobian;
  jacobian.state.setZero();
  jacobian.state(Index::kNorth, Index::kHeading) = -conditions.airspeed * std::sin(state[Index::kHeading]);
  jacobian.state(Index::kEast, Index::kHeading) = conditions.airspeed * std::cos(state[Index::kHeading]);
  jacobian.state(Index::kRoll, Index::kRollRate) = 1.0;
  jacobian.state(Index::kHeading, Index::kRoll) =
      conditions.turn_gain * model.gravity / (conditions.airspeed * cos_roll * cos_roll);
  jacobian.state(Index::kRollRate, Index::kRoll) = -model.a0;
  jacobian.state(Index::kRollRate, Index::kRollRate) = -model.a1;
  jacobian.input.setZero();
  jacobian.input[Index::kRollRate] = model.b0;
  return jacobian;
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

LateralState integrate(const LateralModel& model, const LateralConditions& conditions,
                       const LateralState& state, const LateralStep& step,
                       LateralJacobian& jacobian) noexcept {
  LateralState rate = LateralState::Zero();
  LateralState sum = LateralState::Zero();
  const Sensitivity identity = Sensitivity::Identity();
  // Sensitivity of the stage's rate.
  Sensitivity slope = Sensitivity::Zero();
  Sensitivity slope_sum = Sensitivity::Zero();
  for (int stage = 0; stage < kStages; ++stage) {
    const double time = kStageTime[stage] * step.duration;
    const LateralState looked_at = state + time * rate;
    const LateralJacobian local = lateralRateJacobian(model, conditions, looked_at);
    rate = lateralRate(model, conditions, looked_at, step.roll_reference);
    sum += kStageWeight[stage] * rate;
    const Sensitivity moved = identity + time * slope;
    slope = local.state.lazyProduct(moved);
    slope.col(kInputColumn) += local.input;
    slope_sum += kStageWeight[stage] * slope;
  }
  const Sensitivity total = identity + step.duration * slope_sum;
  jacobian.state = total.leftCols<Index::kSize>();
  jacobian.input = total.col(kInputColumn);
  return state + step.duration * sum;
}

}  // namespace polyfly
