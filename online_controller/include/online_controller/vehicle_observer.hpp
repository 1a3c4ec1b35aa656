#pragma once

#include <Eigen/Core>
#include <array>

#include "online_controller/force_observer.hpp"
#include "online_controller/options.hpp"
#include "online_controller/types.hpp"

namespace polyfly {

/// The attitude loops as an observer of moments sees them, with the names and defaults of mav_control_rw:
/// angle'' = omega^2 (gain command - angle) - 2 damping omega angle' + moment about roll and pitch, and
/// rate' = omega (gain command - rate) + moment about yaw, whose command is a rate.
struct MomentModel {
  double roll_omega = 7.07;    ///< [rad/s]
  double roll_damping = 0.72;  ///< [1]
  double roll_gain = 0.8;      ///< [1]
  double pitch_omega = 7.07;
  double pitch_damping = 0.76;
  double pitch_gain = 0.84;
  double yaw_omega = 5.0;
  double yaw_gain = 1.0;
  double calibration_duration = 5.0;  ///< [s]
};

template <class Options, class Visit>
void visitMomentModel(Options& options, Visit&& visit) {
  visit("KF_observer/roll_omega", options.roll_omega, "rad/s", Range{0.1, 100.0});
  visit("KF_observer/roll_damping", options.roll_damping, "1", Range{0.05, 10.0});
  visit("KF_observer/roll_gain", options.roll_gain, "1", Range{0.01, 10.0});
  visit("KF_observer/pitch_omega", options.pitch_omega, "rad/s", Range{0.1, 100.0});
  visit("KF_observer/pitch_damping", options.pitch_damping, "1", Range{0.05, 10.0});
  visit("KF_observer/pitch_gain", options.pitch_gain, "1", Range{0.01, 10.0});
  visit("KF_observer/yaw_omega", options.yaw_omega, "rad/s", Range{0.1, 100.0});
  visit("KF_observer/yaw_gain", options.yaw_gain, "1", Range{0.01, 10.0});
  visit("KF_observer/calibration_duration", options.calibration_duration, "s", Range{0.1, 1000.0});
}

/// Throws Error naming the key, its range and its value.
void checkMomentModel(const MomentModel& moments);

/// What the observer makes of a vehicle, in W and in roll, pitch, yaw.
struct VehicleEstimate {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();          ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< [m/s]
  Eigen::Vector3d attitude = Eigen::Vector3d::Zero();          ///< yaw of any turn [rad]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< of these angles [rad/s]
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< external, over mass, less the offset [m/s^2]
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< external, over inertia, less the offset [rad/s^2]
  Eigen::Vector3d force_offset = Eigen::Vector3d::Zero();   ///< found by calibration [m/s^2]
  Eigen::Vector3d moment_offset = Eigen::Vector3d::Zero();  ///< [rad/s^2]
};

/// Kalman filters for position, velocity, attitude, rates, external force and external moment: the force by
/// ForceObserver, the moments about each axis by the attitude's model. Whole periods between samples are
/// counted from the stamps; a gap or a stamp that goes back starts the state anew and keeps, or forgets, the
/// rest.
///
/// Calibration at hover takes the mean of force and moment for what is the model's fault: a wrong mass, a
/// thrust curve, a trim. After it they are subtracted.
///
/// update() never throws, allocates, locks, logs or reads a clock.
class VehicleObserver {
 public:
  /// `model` gives gravity and drag. Throws Error when an option is out of range.
  VehicleObserver(const MultirotorModel& model, const MultirotorOptions& vehicle, const MomentModel& moments);

  /// A sane sample, until which `held` was the command.
  void update(const VehicleState& state, const AttitudeCommand& held) noexcept;

  /// Goes on with what another one knows, a calibration under way included, by its own mass and noise.
  void takeOver(const VehicleObserver& other) noexcept;

  void restart() noexcept;  ///< the next sample goes on from where it is; what is known of forces is kept
  void reset() noexcept;    ///< as after construction, but for the offsets

  /// From the next sample on, for calibration_duration.
  void calibrate() noexcept;
  bool isCalibrating() const noexcept { return calibrating_; }
  unsigned calibrations() const noexcept { return calibrations_; }  ///< finished ones

  const VehicleEstimate& estimate() const noexcept { return estimate_; }

 private:
  void updateMoments(const VehicleState& state, const AttitudeCommand& held, int periods) noexcept;
  void advanceCalibration(double stamp, const Eigen::Vector3d& force, const Eigen::Vector3d& moment) noexcept;

  double mass_;
  double period_;
  double duration_;
  ForceObserver force_;
  std::array<DisturbanceObserver, 3> angles_;
  VehicleEstimate estimate_;
  double observed_until_ = 0.0;  // [s]
  bool observing_ = false;

  bool calibrating_ = false;
  unsigned calibrations_ = 0;
  double calibration_start_ = 0.0;  // [s]
  int calibration_samples_ = 0;
  Eigen::Vector3d force_sum_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment_sum_ = Eigen::Vector3d::Zero();
};

}  // namespace polyfly
