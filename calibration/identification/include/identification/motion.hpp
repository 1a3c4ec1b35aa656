#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "identification/fit_loop.hpp"
#include "identification/flight_signals.hpp"

namespace polyfly {

/// What is known of a multirotor before its motion is looked at (Eq. 37).
struct MotionOptions {
  double gravity = 9.8066;  ///< [m/s^2]
  /// Mass [kg]. 0: thrust_cmd is not in newtons.
  double mass = 0.0;
  /// Mass-normalised drag along the axes of W [1/s].
  Eigen::Vector3d drag = Eigen::Vector3d::Zero();
  /// Half width of the sliding mean over velocities [s].
  double smoothing = 0.1;
  /// Windows that are used. Empty: the whole record.
  std::vector<TimeWindow> windows;
  /// True: thrust_cmd is in newtons although it never exceeds 1.
  bool newtons = false;
};

/// Accelerations in W (z up) of one flight, all through the same sliding mean.
struct Motion {
  std::string source;
  /// True: the thrust comes from thrust_cmd and the mass. False: it comes from the vertical acceleration
  /// itself.
  bool thrust_known = false;
  std::vector<double> time;  ///< [s]
  /// First sample of each stretch without a pause, and the number of samples.
  std::vector<Eigen::Index> starts;
  Eigen::MatrixX3d acceleration;  ///< [m/s^2]
  /// Acceleration from thrust, attitude and gravity, without drag [m/s^2].
  Eigen::MatrixX3d expected;
  Eigen::MatrixX3d velocity;  ///< [m/s]
  Eigen::VectorXd yaw;        ///< [rad]
  /// Vertical part of thrust_cmd, in its unit; 0 if there is no thrust_cmd.
  Eigen::VectorXd lift;
  /// True: thrust_cmd is a share of full thrust. False: it is in newtons.
  bool lift_is_share = false;
};

/// From vx, vy, vz, roll, pitch, yaw, and thrust_cmd if a mass is given. A thrust_cmd that never exceeds 1,
/// or that the log is known to hold so, is a share of full thrust. Throws Error naming source and signal,
/// when no stretch is long enough, or when a mass is given and thrust_cmd is such a share.
Motion motionOf(const FlightSignals& signals, const MotionOptions& options);

/// Sentences on what makes any result of this motion doubtful: the vehicle hardly moved, or did not
/// accelerate where it tilted (frame, sign).
std::vector<std::string> checkMotion(const Motion& motion);

/// A model beside what was measured, for pictures; row by row as in `time`.
struct MotionTrace {
  /// Name of the quantity that is compared.
  std::string name;
  std::string unit;
  std::vector<double> time;  ///< [s]
  /// Its stretches without a pause.
  std::vector<TimeWindow> stretches;
  std::vector<double> measured;
  std::vector<double> modelled;
};

/// What acts along one axis and the model does not explain.
struct DisturbanceBound {
  /// Name of the axis: x, y or z.
  std::string axis;
  double mean = 0.0;       ///< [m/s^2]
  double deviation = 0.0;  ///< [m/s^2]
  /// Lower bound [m/s^2]. `share` of the time lies within the bounds, with the stated confidence.
  double least = 0.0;
  /// Upper bound [m/s^2].
  double greatest = 0.0;
  /// Confidence that is reached. It is less than requested where the record is too short.
  double confidence = 0.0;
  /// Number of independent samples that would tell as much as the record.
  double independent_samples = 0.0;
  /// Warnings as sentences.
  std::vector<std::string> warnings;
  /// True: the confidence is reached, checkMotion finds the motion sound, and no bound exceeds gravity.
  bool supported = true;
};

struct BoundOptions {
  /// Share of the time for which the bound holds. Half of the rest lies outside on each side.
  double share = 0.99;
  /// Confidence that the bound holds for this share.
  double confidence = 0.95;
};

/// Bounds on acceleration minus what thrust, attitude, gravity and drag explain, for each axis; z only where
/// the thrust is known; of all flights together. Order statistics at the ranks that the binomial distribution of the
/// independent samples asks for. Flights of which traceDisturbance throws no Error, at least one.
std::vector<DisturbanceBound> boundDisturbance(const std::vector<Motion>& flights,
                                               const MotionOptions& options, const BoundOptions& bound);

/// Parameters with what they explain.
struct MotionFit {
  std::vector<FittedParameter> parameters;
  std::vector<MotionTrace> traces;
  std::vector<std::string> warnings;  ///< sentences
  /// Parameters of each flight, if there are several.
  std::vector<std::vector<FittedParameter>> flights;
};

/// What acts and the model does not explain, along each axis of boundDisturbance: measured acceleration beside what
/// thrust, attitude, gravity and drag give, without parameters. Throws Error where the flights differ in what thrust_cmd is.
MotionFit traceDisturbance(const std::vector<Motion>& flights, const MotionOptions& options);

/// Drag coefficients A_x, A_y along the axes of W, and A_z where the thrust is known [1/s]. Each has the mean
/// disturbance beside it; names drag_x, offset_x, and so on. Then those of the rotors along the body's heading and to
/// its left, with one mean disturbance in W; names drag_forward, drag_left. Of several flights the means
/// (meanParameters); pictures are those of each flight. At least one flight.
MotionFit fitDrag(const std::vector<Motion>& flights);

/// Mass [kg] from the vertical part of a thrust command in newtons, and the command that holds the vehicle
/// [N]; names mass, hover_thrust. Of a command that is a share of full thrust only hover_command, with a
/// warning. Of several flights the means, as in fitDrag. Throws Error if there is no thrust_cmd.
MotionFit fitMass(const std::vector<Motion>& flights, const MotionOptions& options);

}  // namespace polyfly
