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
  /// Share of the roll reference's limit that turns may use; the rest is for gusts.
  double turn_share = 0.9;
  /// Greatest deviation from the path where a turn follows another one, see turn_limits.hpp; 0: no bound [m].
  double turn_deviation = 1.5;
  bool publish_attitude = false;
  AttitudeOptions attitude;
  bool stream_in_standby = false;
  bool require_engaged = false;
  bool watch_autopilot = false;
  /// Greatest age of the autopilot's state [s].
  double autopilot_timeout = 3.0;
  /// Modes of the autopilot that follow.
  std::string engaged_modes = "OFFBOARD";
  /// Greatest age of an angular rate; after it the odometry's rate is used [s].
  double imu_timeout = 0.2;
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
  visit("path/turn_share", parameters.turn_share, "", Range{0.1, 1.0});
  visit("path/turn_deviation", parameters.turn_deviation, "m", Range{0.0, 1000.0});
  visit("output/attitude_target", parameters.publish_attitude);
  visit("output/pitch", parameters.attitude.pitch, "rad", Range{-0.5, 0.5});
  visit("output/thrust", parameters.attitude.thrust, "", Range{-1.0, 1.0});
  visit("output/stream_in_standby", parameters.stream_in_standby);
  visit("input/require_engaged", parameters.require_engaged);
  visit("input/watch_autopilot", parameters.watch_autopilot);
  visit("input/autopilot_timeout", parameters.autopilot_timeout, "s", Range{0.1, 60.0});
  visit("input/engaged_modes", parameters.engaged_modes);
  visit("input/imu_timeout", parameters.imu_timeout, "s", Range{0.0, 10.0});
  visit("provenance", parameters.provenance);
}

/// Sets the guidance's loiter direction, and checks all that a single range does not. Throws Error naming the key,
/// after `where`.
void finishParameters(LateralParameters* parameters, const std::string& where);

/// How missions are planned and checked. Airspeed is the nominal one, wind the stronger of the expected and the
/// present one. The roll is that which `turn_share` of the roll reference holds with the roll bias that was learnt.
/// Turn gain, turn bias and roll loop are those of this aircraft. Where its greatest roll rate is not set,
/// presumedRollRate counts.
TurnPlan turnPlanOf(const LateralParameters& parameters, const GuidanceOutput& present);

/// The parameters in a YAML file, by the rules of the node. Throws Error naming file, field and rule where the node
/// would not start with them.
LateralParameters parseLateralParameters(const std::string& text, const std::string& source);

}  // namespace polyfly
