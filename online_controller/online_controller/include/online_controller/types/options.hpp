#pragma once

#include "polyfly_base/range.hpp"

namespace polyfly {

/// Variances that the Kalman filters of forces and moments use, the laws' and the published one. They are those of
/// the model's error in a control period, and of a measurement. Only their ratios shape the gains. Names and meaning
/// are those of mav_control_rw; its q_force is the square of controller/disturbance_drift.
struct ObserverNoise {
  double q_position = 2.5e-7;        ///< [m^2]
  double q_velocity = 2.5e-5;        ///< [m^2/s^2]
  double q_attitude = 1e-8;          ///< [rad^2]
  double q_angular_velocity = 4e-4;  ///< [rad^2/s^2]
  /// Drift of the moment over inertia [rad^2/s^4].
  double q_torque = 0.04;
  double r_position = 2.5e-5;  ///< [m^2]
  double r_velocity = 4e-4;    ///< [m^2/s^2]
  double r_attitude = 1e-4;    ///< [rad^2]
};

template <class Noise, class Visit>
void visitObserverNoise(Noise& noise, Visit&& visit) {
  const Range drift{0.0, 10.0, 100.0, 1e-6}, measured{1e-10, 10.0, 100.0};
  visit("KF_observer/q_position", noise.q_position, "m^2", drift);
  visit("KF_observer/q_velocity", noise.q_velocity, "m^2/s^2", drift);
  visit("KF_observer/q_attitude", noise.q_attitude, "rad^2", drift);
  visit("KF_observer/q_angular_velocity", noise.q_angular_velocity, "rad^2/s^2", drift);
  visit("KF_observer/q_torque", noise.q_torque, "rad^2/s^4", Range{1e-8, 10.0, 100.0});
  visit("KF_observer/r_position", noise.r_position, "m^2", measured);
  visit("KF_observer/r_velocity", noise.r_velocity, "m^2/s^2", measured);
  visit("KF_observer/r_attitude", noise.r_attitude, "rad^2", measured);
}

/// Constants of the vehicle and of the controller around the maps. The defaults are those of a Firefly.
/// The prediction model itself (attitude loop, drag) comes from the maps.
struct MultirotorOptions {
  double mass = 1.52;       ///< [kg]
  double gravity = 9.8066;  ///< [m/s^2]
  /// Command at which odometry sees no roll: the attitude controller's alignment [rad].
  double roll_trim = 0.0;
  /// Command at which odometry sees no pitch [rad].
  double pitch_trim = 0.0;
  /// Heading of the vehicle minus that of the odometry's attitude, about the z axis of W; see `aligned` [rad].
  /// FlightSupervisor takes it into account; a law alone does not.
  double heading_misalignment = 0.0;
  /// Dead time from an odometry to the effect of its command, over which LawSwitch predicts; 0: that of the law's problems
  /// [s].
  double delay = 0.0;
  /// Nominal time between odometry messages [s].
  double control_period = 0.01;
  double yaw_gain = 1.8;            ///< K_yaw [1/s]
  double yaw_rate_max = 1.5707963;  ///< [rad/s]
  /// Limit of the angle commands that are sent, after Eq. 41 [rad].
  double angle_max = 0.4363323;
  /// Least thrust that is sent, mass-normalised [m/s^2].
  double thrust_min = 5.0;
  /// Greatest thrust that is sent, mass-normalised [m/s^2].
  double thrust_max = 20.0;
  /// Control periods without an answer during which the last command is repeated.
  int hold_periods = 10;
  /// Control periods at hover thrust after hold_periods.
  int level_periods = 200;
  /// Control periods at less than hover thrust after level_periods; then nothing is sent.
  int descend_periods = 800;
  /// Greatest distance between two samples beyond what the velocities explain; 0: any, and any turn [m].
  double jump_distance = 0.5;
  /// Greatest turn between two samples beyond what the body rates explain; 0: any [rad].
  double jump_angle = 1.0;
  /// Longest time for which odometry may repeat itself while the vehicle moves; 0: any [s].
  double repeat_time = 0.1;
  /// Drift of the disturbance per control period in the observer's model: a greater one follows faster [m/s^2].
  double disturbance_drift = 0.005;
  /// Drift of the disturbance's rate per control period in the model of the laws' observers; 0: no rate. The greater
  /// it is, the better they follow what turns with the path. A push then moves the commands' references more, and a
  /// delay that is not known matters more. The robust law has none [m/s^3].
  double disturbance_rate_drift = 0.0;
  /// Whether the laws find in flight by how much drag, gain and lag of the vehicle differ from their model. They
  /// correct their references by that. Needs offset_free. The robust law does not.
  bool adapt_model = true;
  ObserverNoise noise;
  /// Drift of the attitude's trim per control period; 0: only the given trim [rad].
  double trim_drift = 5e-4;
  /// Whether the disturbance estimate is used (Eq. 5-6).
  bool offset_free = true;
  /// Robust law: lag behind the observer of the constant part of the disturbance, which the targets then remove; 0: none
  /// is removed [s].
  double robust_estimate_time = 0.0;
  /// Where a map has no answer: true solves its problem online, false clips to its box.
  bool solve_outside = true;
  /// True: the law linear reads the reference of each stage. False: that of the sample counts for all.
  bool look_ahead = true;
  /// Whether the integral of the position error is added to the estimate, see PositionIntegrator.
  bool integrator = false;
  double integral_gain_xy = 0.2;  ///< [1/s^3]
  double integral_gain_z = 0.3;   ///< [1/s^3]
  /// Limit of the integral of the error [m s].
  double integral_limit = 2.0;
  /// Greatest error that is integrated [m].
  double antiwindup_ball = 0.4;
};

/// The one list of the options: calls visit(key, field, unit, range) for each double and int, and
/// visit(key, field) for each bool. Keys are parameter names relative to a node's private namespace.
template <class Options, class Visit>
void visitOptions(Options& options, Visit&& visit) {
  visit("vehicle/mass", options.mass, "kg", Range{0.01, 1000.0, 1.2});
  visit("vehicle/gravity", options.gravity, "m/s^2", Range{1.0, 30.0, 1.05});
  visit("vehicle/roll_trim", options.roll_trim, "rad", Range{-0.2, 0.2, 1.0, 0.05});
  visit("vehicle/pitch_trim", options.pitch_trim, "rad", Range{-0.2, 0.2, 1.0, 0.05});
  visit("vehicle/heading_misalignment", options.heading_misalignment, "rad",
        Range{-3.1415927, 3.1415927, 1.0, 0.05});
  visit("vehicle/delay", options.delay, "s", Range{0.0, 0.5, 1.0, 0.1});
  visit("controller/control_period", options.control_period, "s", Range{0.0005, 1.0});
  visit("controller/yaw_gain", options.yaw_gain, "1/s", Range{0.0, 20.0, 4.0, 0.1});
  visit("controller/yaw_rate_max", options.yaw_rate_max, "rad/s", Range{0.0, 20.0, 4.0, 0.1});
  visit("controller/angle_max", options.angle_max, "rad", Range{0.01, 1.0, 2.5});
  visit("controller/thrust_min", options.thrust_min, "m/s^2", Range{0.5, 50.0, 2.0});
  visit("controller/thrust_max", options.thrust_max, "m/s^2", Range{1.0, 200.0, 2.0});
  visit("controller/hold_periods", options.hold_periods, "samples", Range{0.0, 1000.0, 10.0, 10.0});
  visit("controller/level_periods", options.level_periods, "samples", Range{0.0, 100000.0, 10.0, 200.0});
  visit("controller/descend_periods", options.descend_periods, "samples", Range{0.0, 1000000.0, 10.0, 800.0});
  visit("controller/jump_distance", options.jump_distance, "m", Range{0.0, 1e6, 10.0, 0.5});
  visit("controller/repeat_time", options.repeat_time, "s", Range{0.0, 10.0, 10.0, 0.05});
  visit("controller/disturbance_drift", options.disturbance_drift, "m/s^2", Range{1e-6, 1.0});
  visit("controller/disturbance_rate_drift", options.disturbance_rate_drift, "m/s^3",
        Range{0.0, 10.0, 10.0, 0.03});
  visit("controller/offset_free", options.offset_free);
  visit("controller/adapt_model", options.adapt_model);
  visit("controller/robust_estimate_time", options.robust_estimate_time, "s", Range{0.0, 100.0, 10.0, 2.0});
  visit("controller/solve_outside", options.solve_outside);
  visit("controller/look_ahead", options.look_ahead);
  visit("controller/integrator", options.integrator);
  visit("controller/integral_gain_xy", options.integral_gain_xy, "1/s^3", Range{0.0, 10.0, 4.0, 0.1});
  visit("controller/integral_gain_z", options.integral_gain_z, "1/s^3", Range{0.0, 10.0, 4.0, 0.1});
  visit("controller/integral_limit", options.integral_limit, "m s", Range{0.0, 100.0, 4.0, 1.0});
  visit("controller/antiwindup_ball", options.antiwindup_ball, "m", Range{0.0, 100.0, 10.0, 0.4});
  visitObserverNoise(options.noise, visit);
}

/// Throws Error naming the key, its range and its value; hover thrust must lie between the thrust limits.
void checkOptions(const MultirotorOptions& options);

}  // namespace polyfly
