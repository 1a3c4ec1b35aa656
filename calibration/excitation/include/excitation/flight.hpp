#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "excitation/plan.hpp"
#include "online_controller/types/types.hpp"
#include "polyfly_base/range.hpp"

namespace polyfly {

/// Limits of the flight, and the loop that holds the vehicle where it is not excited. Distances count from
/// where it started.
struct ExcitationOptions {
  /// True: fixed wing. Only the roll of a wing is excited; its thrust is a constant share 0..1.
  bool wing = false;

  /// Measured roll or pitch beyond which the flight is aborted [rad].
  double attitude_max = 0.6;
  /// Greatest horizontal distance from the start [m].
  double distance_max = 8.0;
  /// Greatest height above or below the start [m].
  double height_max = 2.0;
  /// Greatest time without odometry [s].
  double silence_max = 0.3;
  /// Greatest motion of any joystick axis away from its first position. Full scale is 1.
  double stick_max = 0.15;

  double mass = 1.52;       ///< [kg]
  double gravity = 9.8066;  ///< [m/s^2]
  /// Natural frequency of the position loop [rad/s].
  double hold_frequency = 1.2;
  /// Natural frequency of the height loop [rad/s].
  double height_frequency = 2.0;
  /// Greatest tilt that the position loop commands [rad].
  double tilt_max = 0.25;
  double yaw_gain = 1.0;      ///< [1/s]
  double yaw_rate_max = 0.8;  ///< [rad/s]
  /// Greatest roll and pitch command, excitation included [rad].
  double command_max = 0.6;
  /// Least commanded thrust per mass [m/s^2].
  double thrust_min = 5.0;
  /// Greatest commanded thrust per mass [m/s^2].
  double thrust_max = 16.0;

  /// Distance from the start beyond which a wing turns back [m].
  double wing_return = 100.0;
  /// Greatest roll of a wing that turns back [rad]. It is less while roll is excited too.
  double wing_roll = 0.35;
  /// Trim pitch of a wing [rad].
  double wing_pitch = 0.03;
  double wing_pitch_max = 0.2;  ///< [rad]
  /// Pitch of a wing per height error [rad/m].
  double wing_height_gain = 0.02;
  /// Pitch of a wing against its climb rate [rad s/m].
  double wing_climb_gain = 0.03;
  double wing_thrust = 0.5;  ///< 0..1
};

/// Lists the options once: visit(key, field, unit, range), visit(key, field) for a flag.
template <class Options, class Visitor>
void visitExcitation(Options& self, Visitor&& visit) {
  visit("vehicle/wing", self.wing);
  visit("limits/attitude_max", self.attitude_max, "rad", Range{0.05, 1.4});
  visit("limits/distance_max", self.distance_max, "m", Range{0.1, 100000.0});
  visit("limits/height_max", self.height_max, "m", Range{0.1, 10000.0});
  visit("limits/silence_max", self.silence_max, "s", Range{0.01, 10.0});
  visit("limits/stick_max", self.stick_max, "", Range{0.01, 2.0});
  visit("vehicle/mass", self.mass, "kg", Range{0.01, 1000.0});
  visit("vehicle/gravity", self.gravity, "m/s^2", Range{1.0, 30.0});
  visit("hold/frequency", self.hold_frequency, "rad/s", Range{0.0, 10.0});
  visit("hold/height_frequency", self.height_frequency, "rad/s", Range{0.1, 20.0});
  visit("hold/tilt_max", self.tilt_max, "rad", Range{0.0, 0.8});
  visit("hold/yaw_gain", self.yaw_gain, "1/s", Range{0.0, 20.0});
  visit("hold/yaw_rate_max", self.yaw_rate_max, "rad/s", Range{0.0, 10.0});
  visit("command/angle_max", self.command_max, "rad", Range{0.01, 1.0});
  visit("command/thrust_min", self.thrust_min, "m/s^2", Range{0.5, 50.0});
  visit("command/thrust_max", self.thrust_max, "m/s^2", Range{1.0, 200.0});
  visit("wing/return_distance", self.wing_return, "m", Range{1.0, 100000.0});
  visit("wing/roll", self.wing_roll, "rad", Range{0.01, 1.0});
  visit("wing/pitch", self.wing_pitch, "rad", Range{-0.5, 0.5});
  visit("wing/pitch_max", self.wing_pitch_max, "rad", Range{0.01, 0.8});
  visit("wing/height_gain", self.wing_height_gain, "rad/m", Range{0.0, 1.0});
  visit("wing/climb_gain", self.wing_climb_gain, "rad s/m", Range{0.0, 1.0});
  visit("wing/thrust", self.wing_thrust, "", Range{0.0, 1.0});
}

enum class ExcitationState {
  /// The flight waits for the first odometry.
  kWaiting,
  /// Rests and manoeuvres are flown.
  kRunning,
  /// The plan is flown. The vehicle is held.
  kDone,
  /// A limit was passed. The vehicle is held where that happened.
  kAborted,
  /// The pilot moved a stick. Nothing is commanded any more.
  kHandedOver,
};
const char* nameOf(ExcitationState state);

/// Flies a plan: adds its deviations to a loop that holds position, height and heading, and watches the
/// limits. Free of ROS and clocks; the time is that of the odometry.
///
/// During 2-1-1, roll and pitch of the loop stand still, so that the response is that to the pulses.
/// Height is held all the time. An aborted flight is not taken up again.
class ExcitationFlight {
 public:
  /// Throws Error when an option is out of range, options do not fit together, or a wing's plan excites
  /// another channel than roll.
  ExcitationFlight(ExcitationPlan plan, const ExcitationOptions& options);

  /// The command for this sample of odometry. Odometry that is not finite or older than the last aborts.
  AttitudeCommand step(const VehicleState& state) noexcept;

  /// No odometry by `time` [s]: the command to send, level and hovering, or nothing new. Aborts when the
  /// silence is longer than its limit.
  bool onSilence(double time, AttitudeCommand* command) noexcept;

  /// Axes of the joystick. The first call notes where they are.
  void onSticks(const std::vector<float>& axes);

  /// The pilot, or who engaged the flight, takes it back: nothing is commanded any more. `reason` must live
  /// on.
  void handOver(const char* reason) noexcept;

  ExcitationState state() const { return state_; }
  bool commands() const { return state_ != ExcitationState::kHandedOver; }
  /// Index of the running manoeuvre; -1 in a rest.
  int running() const { return running_; }
  /// Time since the start of the plan [s].
  double elapsed() const { return elapsed_; }
  /// Reason of an abort or of a handover; "" otherwise.
  const char* reason() const { return reason_; }
  const ExcitationPlan& plan() const { return plan_; }
  /// Position where the vehicle is held.
  const Eigen::Vector3d& home() const { return home_; }

 private:
  void begin(const VehicleState& state);
  void abort(const char* reason, const VehicleState* at);
  const char* brokenLimit(const VehicleState& state) const;
  AttitudeCommand holdMultirotor(const VehicleState& state) const;
  AttitudeCommand holdWing(const VehicleState& state) const;
  AttitudeCommand limited(AttitudeCommand command) const;
  AttitudeCommand level() const;

  ExcitationPlan plan_;
  ExcitationOptions options_;
  ExcitationState state_ = ExcitationState::kWaiting;
  const char* reason_ = "";
  Eigen::Vector3d home_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d start_ = Eigen::Vector3d::Zero();
  double heading_ = 0.0;
  double start_stamp_ = 0.0;
  double last_stamp_ = 0.0;
  double elapsed_ = 0.0;
  int running_ = -1;
  AttitudeCommand frozen_;
  std::vector<float> sticks_;
};

}  // namespace polyfly
