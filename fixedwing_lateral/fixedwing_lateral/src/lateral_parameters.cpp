#include "fixedwing_lateral/lateral_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "polyfly_base/error.hpp"
#include "polyfly_base/options_from_yaml.hpp"
#include "polyfly_base/options_text.hpp"

namespace polyfly {
namespace {

// Share of the roll reference's limit that turns may use; the rest is for gusts.
constexpr double kTurnShare = 0.9;
// Greatest deviation from the path where a turn follows another one [m].
constexpr double kTurnDeviation = 1.5;

}  // namespace

void finishParameters(LateralParameters* parameters, const std::string& where) {
  if (parameters->loiter_direction == 0)
    throw Error(where + ": path/loiter_direction: must be 1 (right) or -1 (left)");
  parameters->guidance.loiter.direction =
      parameters->loiter_direction > 0 ? TurnDirection::kRight : TurnDirection::kLeft;
  if (parameters->as_published) removeAdditions(parameters->guidance);
  tightTurnsOf(parameters->tight_turns, where + ": path/tight_turns");
  checkGuidance(parameters->guidance, where);
}

TurnPlan turnPlanOf(const LateralParameters& parameters, const GuidanceOutput& present) {
  const GuidanceOptions& guidance = parameters.guidance;
  const LateralLimits& limits = guidance.limits;
  // A held reference phi_r flies the roll (phi_r + bias) b0 / a0.
  const double reference = std::max(0.0, limits.roll_reference - std::abs(present.roll_bias));
  const double roll = std::min(limits.roll, reference * guidance.model.b0 / guidance.model.a0);
  TurnPlan plan;
  plan.tight = tightTurnsOf(parameters.tight_turns, "path/tight_turns");
  plan.conditions.airspeed = guidance.airspeed_nominal;
  plan.conditions.wind_speed = std::max(parameters.wind_expected, present.wind.norm());
  plan.conditions.roll = kTurnShare * roll;
  plan.conditions.turn_gain = present.turn_gain;
  plan.conditions.turn_bias = std::abs(present.turn_bias);
  plan.conditions.roll_rate = guidance.model.roll_rate_max > 0.0
                                  ? guidance.model.roll_rate_max
                                  : presumedRollRate(guidance.airspeed_nominal);
  plan.conditions.roll_variance = rollVariance(guidance.model);
  plan.conditions.deviation = kTurnDeviation;
  return plan;
}

LateralParameters parseLateralParameters(const std::string& text, const std::string& source) {
  OptionsFromYaml reader(text, source);
  LateralParameters parameters;
  visitLateralParameters(parameters, reader);
  const std::vector<std::string> own(kLateralGroups.begin(), kLateralGroups.end());
  std::vector<std::string> known = own;
  known.push_back(kInForceGroup);
  reader.refuseUnknownGroups(known, {"provenance"});
  reader.refuseUnknownKeys(own);
  finishParameters(&parameters, source);
  return parameters;
}

}  // namespace polyfly
