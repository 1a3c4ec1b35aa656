#pragma once

#include "online_controller/types/thrust_curve.hpp"
#include "polyfly_base/range.hpp"

namespace polyfly {

/// What the node needs beyond the controller's own options.
struct NodeOptions {
  /// Control periods without odometry after which it counts as silent.
  int stale_periods = 10;
};

template <class Options, class Visit>
void visitNodeOptions(Options& options, Visit&& visit) {
  visit("controller/stale_periods", options.stale_periods, "control periods", Range{2.0, 10000.0});
}

/// Where a sensor_msgs/Joy has what; the defaults are those of mav_control_rw's ACI remote control. A
/// negative scale turns an axis round.
struct JoyLayout {
  int axis_forward = 0;
  int axis_left = 1;
  int axis_up = 2;
  int axis_turn = 3;
  /// Up to -0.5 manual, from 0.5 on position, between them neither; -1: always position.
  int axis_mode = 4;
  /// 1: the remote control is on; -1: always.
  int button_on = 0;
  double scale_forward = 1.0;
  double scale_left = 1.0;
  double scale_up = 1.0;
  double scale_turn = 1.0;
};

template <class Options, class Visit>
void visitJoyLayout(Options& options, Visit&& visit) {
  const Range index{-1.0, 100.0}, scale{-10.0, 10.0};
  visit("rc/axis_forward", options.axis_forward, "", index);
  visit("rc/axis_left", options.axis_left, "", index);
  visit("rc/axis_up", options.axis_up, "", index);
  visit("rc/axis_turn", options.axis_turn, "", index);
  visit("rc/axis_mode", options.axis_mode, "", index);
  visit("rc/button_on", options.button_on, "", index);
  visit("rc/scale_forward", options.scale_forward, "", scale);
  visit("rc/scale_left", options.scale_left, "", scale);
  visit("rc/scale_up", options.scale_up, "", scale);
  visit("rc/scale_turn", options.scale_turn, "", scale);
}

/// In which messages commands leave.
struct OutputOptions {
  /// Whether mav_msgs/RollPitchYawrateThrust is sent.
  bool roll_pitch_yawrate_thrust = true;
  /// Whether mavros_msgs/AttitudeTarget is sent.
  bool attitude_target = false;
  /// Thrust curve of the AttitudeTarget.
  ThrustCurveOptions thrust;
};

template <class Options, class Visit>
void visitOutputOptions(Options& options, Visit&& visit) {
  visit("output/roll_pitch_yawrate_thrust", options.roll_pitch_yawrate_thrust);
  visit("output/attitude_target", options.attitude_target);
  visit("output/hover_thrust", options.thrust.hover_thrust, "", Range{0.01, 0.99});
  visit("output/thrust_polynomial", options.thrust.polynomial);
}

/// Throws Error when nothing is sent.
void checkOutputOptions(const OutputOptions& options);

}  // namespace polyfly
