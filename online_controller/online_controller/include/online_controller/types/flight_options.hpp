#pragma once

#include "online_controller/types/options.hpp"
#include "online_controller/types/reference_limits.hpp"
#include "polyfly_base/range.hpp"

namespace polyfly {

/// How take-off, landing and remote control go, and which references are taken. Names and defaults of
/// mav_control_rw where it has them.
struct FlightOptions {
  /// Height of a take-off above the point where it started [m].
  double takeoff_distance = 1.0;
  /// Duration of a take-off [s].
  double takeoff_time = 5.0;
  double landing_speed = 0.5;  ///< [m/s]
  /// Distance of the commanded position at full stick [m].
  double rc_teleop_max_carrot_distance_position = 1.0;
  /// Distance of the commanded yaw at full stick [rad].
  double rc_teleop_max_carrot_distance_yaw = 0.78539816;
  /// Roll and pitch command at full stick in manual mode [rad].
  double rc_max_roll_pitch_command = 0.78539816;
  /// Yaw rate command at full stick in manual mode [rad/s].
  double rc_max_yaw_rate_command = 0.78539816;
  double stick_deadzone = 0.1;  ///< [1]
  /// Time without a message after which the remote control counts as off; 0: never [s].
  double rc_timeout = 1.0;
  /// True: after a failsafe the interrupted task goes on. False: the vehicle holds where it is.
  bool resume = true;
  /// True: before anything has started the vehicle, its autopilot gets the set-points that it needs to become guided, see
  /// idleCommand().
  bool offboard_stream = false;
  ReferenceLimits reference_limits;
};

/// The one list of these options, as visitOptions of MultirotorOptions.
template <class Options, class Visit>
void visitFlightOptions(Options& options, Visit&& visit) {
  visit("control_interface/takeoff_distance", options.takeoff_distance, "m", Range{0.1, 1000.0});
  visit("control_interface/takeoff_time", options.takeoff_time, "s", Range{0.5, 1000.0});
  visit("control_interface/landing_speed", options.landing_speed, "m/s", Range{0.05, 5.0});
  visit("control_interface/rc_teleop_max_carrot_distance_position",
        options.rc_teleop_max_carrot_distance_position, "m", Range{0.0, 100.0});
  visit("control_interface/rc_teleop_max_carrot_distance_yaw", options.rc_teleop_max_carrot_distance_yaw,
        "rad", Range{0.0, 1.5707964});
  visit("control_interface/rc_max_roll_pitch_command", options.rc_max_roll_pitch_command, "rad",
        Range{0.0, 1.0});
  visit("control_interface/rc_max_yaw_rate_command", options.rc_max_yaw_rate_command, "rad/s",
        Range{0.0, 20.0});
  visit("control_interface/stick_deadzone", options.stick_deadzone, "1", Range{0.0, 0.9});
  visit("control_interface/rc_timeout", options.rc_timeout, "s", Range{0.0, 1000.0});
  visit("control_interface/resume", options.resume);
  visit("control_interface/offboard_stream", options.offboard_stream);
  visitReferenceLimits(options.reference_limits, visit);
}

/// Throws Error naming the key, its range and its value.
void checkFlightOptions(const FlightOptions& options);

}  // namespace polyfly
