#pragma once

#include "fixedwing_plant/airframe.hpp"

namespace polyfly {

/// The inner loops of a small autopilot: roll by roll rate, a damper in yaw, pitch for altitude, throttle for
/// airspeed. Nothing in it removes a steady error of roll, and the damper leaves a slip in turns.
struct AutopilotOptions {
  /// Airspeed to hold [m/s].
  double airspeed = 14.0;
  /// Altitude to hold [m].
  double altitude = 80.0;
  /// Roll rate per roll error [1/s].
  double roll_gain = 3.5;
  /// Greatest commanded roll rate [rad/s].
  double roll_rate_max = 1.2;
  /// Aileron per commanded roll rate [s].
  double aileron_feedforward = 0.27;
  /// Aileron per roll rate error [s].
  double aileron_gain = 0.1;
  /// Rudder per yaw rate error [s].
  double rudder_gain = 0.15;
  /// Climb rate per altitude error [1/s].
  double climb_gain = 0.3;
  /// Greatest commanded climb rate [m/s].
  double climb_max = 2.0;
  /// Pitch per climb rate error [rad s/m].
  double pitch_gain = 0.04;
  double pitch_integral = 0.02;  ///< [rad/m]
  /// Elevator per pitch error [-].
  double elevator_gain = 0.8;
  /// Elevator per pitch rate [s].
  double elevator_damping = 0.05;
  /// Throttle per airspeed error [s/m].
  double throttle_gain = 0.15;
  double throttle_integral = 0.05;  ///< [1/m]
};

/// What the autopilot measures.
struct AutopilotInput {
  double roll = 0.0, pitch = 0.0;                   ///< [rad]
  Eigen::Vector3d rates = Eigen::Vector3d::Zero();  ///< [rad/s]
  double airspeed = 0.0;                            ///< [m/s]
  double altitude = 0.0;                            ///< [m]
  double climb_rate = 0.0;                          ///< [m/s]
};

class Autopilot {
 public:
  /// Begins at the trim, which it works around.
  Autopilot(const AutopilotOptions& options, const Trim& trim) : options_(options), trim_(trim) {}

  Controls step(double roll_reference, const AutopilotInput& input, double duration);

 private:
  AutopilotOptions options_;
  Trim trim_;
  double pitch_integral_ = 0.0;     // [rad]
  double throttle_integral_ = 0.0;  // [-]
};

}  // namespace polyfly
