#pragma once

#include "online_controller/estimation/repeat_check.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// Lets through the odometry that one vehicle can have flown. A sample is refused when it
/// - is not valid (kNotFinite, see isValid);
/// - repeats itself while the vehicle must be moving (kStale, see RepeatCheck): it counts as silence;
/// - bears a stamp before that of the last accepted one, or more than a second after the last one in time without a
///   silence between them (kOutOfOrder);
/// - lies further from the last accepted one than its velocities, 20 m/s^2 and jump_distance explain (kJump);
/// - is an outlier of the attitude (kJump): turned by more than 20 rad/s^2 and jump_angle explain, from where
///   the attitude was and from where the body rates have led it since.
///
/// Time and place may truly begin anew (another bag, a relocalisation). After hold_periods refused samples in a row that
/// agree with each other, the next one that agrees is accepted, as a restart.
///
/// A wrong attitude drives the vehicle away; level attitude does not. So another attitude is accepted only after
/// hold_periods and level_periods, when the FailsafePolicy would begin to descend. It is not accepted while the mean
/// velocity differs by more than 0.2 m/s from the motion of the positions. Then only the attitude is wrong.
class OdometryGate {
 public:
  struct Verdict {
    ControlReason refusal = ControlReason::kNone;
    /// True when the sample is accepted, but does not continue from the last accepted one.
    bool restarted = false;
    /// Where time began anew with it: its stamp minus that of the last accepted one; else 0 [s].
    double time_jump = 0.0;
  };

  explicit OdometryGate(const MultirotorOptions& options) noexcept : options_(options) {}

  /// Other options from the next sample on.
  void setOptions(const MultirotorOptions& options) noexcept { options_ = options; }

  Verdict check(const VehicleState& state) noexcept;

  /// Odometry is silent: the next stamp may lie any time after the last one.
  void noteSilence() noexcept { silent_ = true; }

  /// See RepeatCheck::commanded.
  void commanded(const AttitudeCommand& command) noexcept { repeat_.commanded(command, options_); }

 private:
  ControlReason compare(const VehicleState& before, const VehicleState& state) const noexcept;
  bool hasTurned(const VehicleState& before, const VehicleState& state) const noexcept;
  void addCandidate(const VehicleState& state, bool agrees) noexcept;
  bool isElsewhere() const noexcept;

  MultirotorOptions options_;
  RepeatCheck repeat_;
  // Last accepted sample.
  VehicleState last_;
  // Last sample in time. Where its attitude jumped, it has the attitude to which the body rates led.
  VehicleState led_;
  // Last refused sample.
  VehicleState candidate_;
  // First of the refused samples that agree.
  VehicleState first_candidate_;
  // Integral of the velocities since first_candidate_ [m].
  Eigen::Vector3d candidate_way_ = Eigen::Vector3d::Zero();
  bool started_ = false;
  // True when there was silence since the last accepted sample.
  bool silent_ = false;
  // Number of refused samples in a row that agree.
  int agreeing_ = 0;
};

}  // namespace polyfly
