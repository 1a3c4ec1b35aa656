#pragma once

#include <array>
#include <optional>

#include "mpc_core/observer.hpp"
#include "online_controller/types/attitude.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// angle' = (gain command - angle) / time about roll and pitch, as the law predicts them.
struct TiltModel {
  double roll_gain = 0.9;    ///< [1]
  double roll_time = 0.25;   ///< [s]
  double pitch_gain = 0.9;   ///< [1]
  double pitch_time = 0.25;  ///< [s]
};

/// How the attitude loops differ from the law's model of them, angle' = (gain command - angle) / time about
/// roll and pitch, as a Kalman filter finds it from the measured attitude.
///
/// The trim: the commands at which odometry sees the vehicle level, those of the options and what is found
/// beside them. So neither an inner loop of another gain, nor a frame that is not aligned, nor a centre of
/// mass off the middle (an external moment) leaves an offset: an estimate of the force alone cannot explain
/// them. Estimates of more than kMost are none: the vehicle is held by something.
///
/// The coupling c: what a yaw rate r does to a tilted vehicle,
///
///     roll' = (gain u - roll) / time + c r pitch,  pitch' = (gain u - pitch) / time - c r roll.
///
/// With 0 the loops hold the Euler angles, and the tilt turns with the body (Eq. 37; PX4). With 1 they are
/// loops of rates about the body's axes, and the tilt stays in W while the body yaws (RotorS). It is found
/// while the vehicle yaws with a tilt.
class AttitudeTrim {
 public:
  /// Greatest angle that counts as a trim [rad].
  static constexpr double kMost = 0.1;

  /// Finds no trim with options.trim_drift 0 or options.offset_free unset, no coupling with
  /// options.coupling_drift 0. Throws Error when the model's times or gains are not above 0.
  AttitudeTrim(const TiltModel& model, const MultirotorOptions& options);

  /// Roll and pitch were measured `periods` control periods after the last time; meanwhile `held` was the
  /// command.
  void update(const TiltAngles& measured, const AttitudeCommand& held, int periods) noexcept;

  void reset() noexcept;
  void transferState(const AttitudeTrim& other) noexcept;

  /// The trim, to be added to a command [rad].
  TiltAngles angles() const noexcept;
  double coupling() const noexcept { return coupling_; }

  /// The trim to be level with when nothing corrects it any more: what is found counts only after it has lain
  /// within its bound for kSettled, which is as long as it takes to find it.
  TiltAngles level() const noexcept;
  static constexpr double kSettled = 4.0;  ///< [s]

  /// What makes the vehicle's loops those of a law whose model has `wanted` for the coupling: the trim, and
  /// what undoes the coupling that was found. To be added to a command with that yaw rate [rad].
  TiltAngles added(const TiltAngles& tilt, double yaw_rate, double wanted) const noexcept;

  /// The command that turns the tilt as a coupling of 1 does [rad].
  TiltAngles turn(const TiltAngles& tilt, double yaw_rate) const noexcept;

 private:
  void learnCoupling(const TiltAngles& measured, const AttitudeCommand& held) noexcept;

  TiltModel model_;
  TiltAngles given_;
  // Observers for roll and pitch.
  std::optional<std::array<DisturbanceObserver, 2>> loops_;

  double period_;  // [s]
  // Number of periods in which the trim has been within its bound.
  int within_ = 0;
  double given_coupling_;
  double coupling_drift_;
  // Factor by which the angles decay in a control period.
  TiltAngles decay_;
  double coupling_;
  // Variance of the coupling.
  double variance_;
  // Last measured angles.
  TiltAngles last_;
  bool measured_ = false;
};

}  // namespace polyfly
