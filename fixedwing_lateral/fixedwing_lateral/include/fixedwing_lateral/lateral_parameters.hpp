#pragma once

#include <array>
#include <string>

#include "fixedwing_lateral/guidance.hpp"
#include "fixedwing_lateral/guidance_options.hpp"
#include "fixedwing_lateral/turn_limits.hpp"

namespace polyfly {

/// The groups of a fixed wing's parameters.
constexpr std::array<const char*, 9> kLateralGroups{"horizon", "weights",  "limits", "safety", "model",
                                                    "path",    "guidance", "output", "input"};

/// Pitch and thrust of the mavros_msgs/AttitudeTarget.
struct AttitudeOptions {
  double pitch = 0.0;    ///< positive nose up [rad]
  double thrust = -1.0;  ///< 0..1; ignored when negative
};

/// All that a fixed wing's node reads from its private parameters.
struct LateralParameters {
  GuidanceOptions guidance;
  /// 1: loiters turn right, -1: left.
  int loiter_direction = 1;
  /// Value of path/tight_turns: keep, refuse or widen.
  std::string tight_turns = "keep";
  /// Wind speed for which missions are checked [m/s].
  double wind_expected = 0.0;
  /// Whether the additions to the published controller are off, see removeAdditions.
  bool as_published = false;
  bool publish_attitude = false;
  AttitudeOptions attitude;
  bool require_engaged = false;
  bool watch_autopilot = false;
  /// Modes of the autopilot that follow.
  std::string engaged_modes = "OFFBOARD";
  /// Where calibrated numbers come from: the text of `calibrate apply`.
  std::string provenance;
};

/// The one list of all parameters: visitGuidance, and those of the node around the guidance.
template <class Parameters, class Visit>
void visitLateralParameters(Parameters& parameters, Visit&& visit) {
  visitGuidance(parameters.guidance, visit);
  visit("path/loiter_direction", parameters.loiter_direction, "", Range{-1.0, 1.0});
  visit("path/tight_turns", parameters.tight_turns);
  visit("path/wind_expected", parameters.wind_expected, "m/s", Range{0.0, 100.0});
  visit("guidance/as_published", parameters.as_published);
  visit("output/attitude_target", parameters.publish_attitude);
  visit("output/pitch", parameters.attitude.pitch, "rad", Range{-0.5, 0.5});
  visit("output/thrust", parameters.attitude.thrust, "", Range{-1.0, 1.0});
  visit("input/require_engaged", parameters.require_engaged);
  visit("input/watch_autopilot", parameters.watch_autopilot);
  visit("input/engaged_modes", parameters.engaged_modes);
  visit("provenance", parameters.provenance);
}

/// Sets what the guidance has no parameter of its own for, and checks all that a single range does not. Throws Error naming the key,
/// after `where`.
void finishParameters(LateralParameters* parameters, const std::string& where);

/// How missions are planned and checked. Airspeed is the nominal one, wind the stronger of the expected and the
/// present one. The roll is that which nine tenths of the roll reference hold with the roll bias that was learnt.
/// Turn gain, turn bias and roll loop are those of this aircraft. Where its greatest roll rate is not set,
/// presumedRollRate counts.
TurnPlan turnPlanOf(const LateralParameters& parameters, const GuidanceOutput& present);

/// The parameters in a YAML file, by the rules of the node. Throws Error naming file, field and rule where the node
/// would not start with them.
LateralParameters parseLateralParameters(const std::string& text, const std::string& source);

}  // namespace polyfly
