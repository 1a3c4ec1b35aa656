#pragma once

#include <array>
#include <optional>

#include "mpc_core/coefficient_estimate.hpp"
#include "mpc_core/observer.hpp"
#include "online_controller/types/attitude.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// Roll and pitch that the reference itself needs, and their derivatives. What holds against a disturbance is no part of
/// them: in a constant wind a gain could not be told from a trim.
struct FollowedTilt {
  TiltAngles angle;  ///< [rad]
  TiltAngles rate;   ///< [rad/s]
};

/// What of the reference a command follows. 0 where it rests.
struct FollowedReference {
  FollowedTilt tilt;
  /// The tilt in all, with what holds against the disturbance [rad].
  TiltAngles whole_tilt;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
};

/// What the vehicle flies of it; empty where the reference tells nothing of what the loops and the drag do.
struct FlownReference {
  std::optional<FollowedTilt> tilt;
  std::optional<Eigen::Vector3d> velocity;  ///< [m/s]
};

/// The vehicle flies what it follows while the tilt is within 0.1 rad of the whole one, and the velocity within 0.5 m/s.
FlownReference flown(const FollowedReference& followed, const TiltAngles& tilt,
                     const Eigen::Vector3d& velocity) noexcept;

/// How the attitude loops differ from the law's model of them, angle' = (gain command - angle) / time about roll and
/// pitch. A Kalman filter finds it from the measured attitude.
///
/// The trim: the commands at which odometry sees the vehicle level, those of the options and what is found beside
/// them. So no offset is left by an inner loop of another gain, or by a frame that is not aligned. None is left by a
/// centre of mass off the middle (an external moment). An estimate of the force alone cannot explain these. Estimates
/// of more than kMost are none: the vehicle is held by something.
///
/// The coupling c: what a yaw rate r does to a tilted vehicle,
///
///     roll' = (gain u - roll) / time + c r pitch,  pitch' = (gain u - pitch) / time - c r roll.
///
/// With 0 the loops hold the Euler angles, and the tilt turns with the body (Eq. 37; PX4). With 1 they are
/// loops of rates about the body's axes, and the tilt stays in W while the body yaws (RotorS). It is found
/// while the vehicle yaws with a tilt.
///
/// Gain and lag: along a reference s the loops need the command (1 / gain + c1) s + (time / gain + c2) s' + trim. c1 and
/// c2 are found while the reference's tilt changes (CoefficientEstimate), so that an error that turns with the path is
/// none of the trim.
class AttitudeTrim {
 public:
  /// Greatest angle that counts as a trim [rad].
  static constexpr double kMost = 0.1;

  /// Finds no trim with options.trim_drift 0 or options.offset_free unset, then no gain and lag either, nor with
  /// options.adapt_model unset. Throws Error when the model's times or gains are
  /// not above 0.
  AttitudeTrim(const TiltModel& model, const MultirotorOptions& options);

  /// Roll and pitch were measured `periods` control periods after the last time; meanwhile `held` was the
  /// command. Gain and lag are learnt from what was `followed` then; without it they are forgotten.
  void update(const TiltAngles& measured, const AttitudeCommand& held, int periods,
              const std::optional<FollowedTilt>& followed = FollowedTilt{}) noexcept;

  void reset() noexcept;
  /// Gain and lag are those of the model again.
  void forgetLoops() noexcept;
  void transferState(const AttitudeTrim& other) noexcept;

  /// The trim, to be added to a command [rad].
  TiltAngles angles() const noexcept;
  double coupling() const noexcept { return coupling_; }
  /// The model with the gains and lags that were found.
  TiltModel loops() const noexcept;

  /// The trim to be level with when nothing corrects it any more. What is found counts only after it has lain within
  /// its bound for kSettled. That is as long as it takes to find it.
  TiltAngles level() const noexcept;
  static constexpr double kSettled = 4.0;  ///< [s]

  /// What makes the vehicle's loops those of a law whose model has `wanted` for the coupling. It is the trim, and
  /// what undoes the coupling that was found. To be added to a command with that yaw rate [rad].
  TiltAngles added(const TiltAngles& tilt, double yaw_rate, double wanted) const noexcept;

  /// What gain and lag that differ from the model's need beside, c1 s + c2 s' [rad].
  TiltAngles feedForward(const FollowedTilt& followed, double yaw_rate) const noexcept;

  /// The command that turns the tilt as a coupling of 1 does [rad].
  TiltAngles turn(const TiltAngles& tilt, double yaw_rate) const noexcept;

 private:
  // A loop's observer, and c1 and c2 where they are found.
  struct Loop {
    DisturbanceObserver observer;
    double gain, time;
    std::optional<CoefficientEstimate> by_angle, by_rate;
    // 1 / gain + c1 and time / gain + c2.
    double stiffness() const noexcept { return 1.0 / gain + (by_angle ? by_angle->value() : 0.0); }
    double damping() const noexcept { return time / gain + (by_rate ? by_rate->value() : 0.0); }
  };
  static Loop makeLoop(double gain, double time, const MultirotorOptions& options);
  void updateLoop(Loop& loop, double measured, double command, double turned, int periods) const noexcept;
  FollowedTilt inLoops(const FollowedTilt& followed, double yaw_rate) const noexcept;
  void learnCoupling(const TiltAngles& measured, const AttitudeCommand& held) noexcept;

  TiltModel model_;
  TiltAngles given_;
  // Of roll and pitch.
  std::optional<std::array<Loop, 2>> loops_;

  double period_;  // [s]
  // Number of periods in which the trim has been within its bound.
  int within_ = 0;
  double coupling_ = 0.0;
  // Variance of the coupling.
  double variance_;
  // Last measured angles.
  TiltAngles last_;
  bool measured_ = false;
};

}  // namespace polyfly
