#pragma once

#include "online_controller/estimation/repeat_check.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// Lets through the odometry that one vehicle can have flown. A sample is refused when it
/// - is not valid (kNotFinite, see isValid);
/// - repeats itself while the vehicle must be moving (kStale, see RepeatCheck), or is one of more than hold_periods
///   samples in a row with one stamp: it counts as silence;
/// - bears a stamp before that of the last accepted one, or more than a second after the last one in time without a
///   silence between them (kOutOfOrder);
/// - lies further from the last accepted one than its velocities, 20 m/s^2 and jump_distance explain (kJump);
/// - is turned by more than 20 rad/s^2 and jump_angle explain, from where the attitude was and from where the body
///   rates have led it since (kJump): from one sample to the next, or over five seconds where there are rates.
///
/// Time and place may truly begin anew (another bag, a relocalisation). After hold_periods refused samples in a row that
/// agree with each other, the next one that agrees is accepted, as a restart.
///
/// A wrong attitude drives the vehicle away; level attitude does not. So another attitude is accepted only after
/// hold_periods and level_periods, when the FailsafePolicy would begin to descend. It is not accepted while the mean
/// velocity differs by more than 0.2 m/s from the motion of the positions. Then only the attitude is wrong. An attitude
/// to which the body rates have led over the last minute is accepted at once: that before was wrong.
///
/// A velocity that does not lead from position to position, beyond 0.2 m and 20 % of the way in about a second, is
/// replaced by the filtered differences of the positions (Verdict::contradicts). This covers another sign, unit or frame.
/// An attitude that leaves where the rates lead, while the velocity of a vehicle above 0.5 m/s goes on, is replaced by
/// theirs for up to ten seconds: the frame has not turned.
class OdometryGate {
 public:
  struct Verdict {
    ControlReason refusal = ControlReason::kNone;
    /// True when the sample is accepted, but does not continue from the last accepted one, or its velocity is
    /// replaced and that one's was not, or the reverse.
    bool restarted = false;
    /// Where time began anew with it: its stamp minus that of the last accepted one; else 0 [s].
    double time_jump = 0.0;
    /// True when the velocity or the attitude was replaced.
    bool contradicts = false;
  };

  explicit OdometryGate(const MultirotorOptions& options) noexcept : options_(options) {}

  /// Other options from the next sample on.
  void setOptions(const MultirotorOptions& options) noexcept { options_ = options; }

  /// Judges the next sample, and replaces a velocity or an attitude that contradicts the rest.
  Verdict check(VehicleState& state) noexcept;

  /// Odometry is silent: the next stamp may lie any time after the last one.
  void noteSilence() noexcept { silent_ = true; }

  /// See RepeatCheck::commanded.
  void commanded(const AttitudeCommand& command) noexcept { repeat_.commanded(command, options_); }

 private:
  /// Position and velocity by the positions alone, and what the reported velocity lacks.
  struct Way {
    void begin(const VehicleState& state) noexcept;
    void add(const VehicleState& before, const VehicleState& state) noexcept;

    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // [m]
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // [m/s]
    // Way that the reported velocities do not explain, and length of the way, both forgotten within a second [m].
    Eigen::Vector3d unexplained = Eigen::Vector3d::Zero();
    double length = 0.0;
    bool contradicts = false;
  };

  /// Attitudes to which the rates lead, drawn to the accepted ones.
  struct Memory {
    void begin(const Eigen::Quaterniond& attitude) noexcept;
    void lead(const VehicleState& before, const VehicleState& state) noexcept;
    void judgeRates(const VehicleState& state) noexcept;
    void draw(const Eigen::Quaterniond& attitude, double elapsed) noexcept;

    Eigen::Quaterniond led = Eigen::Quaterniond::Identity();
    Eigen::Quaterniond long_led = Eigen::Quaterniond::Identity();
    // Mean direction of up in the body, of the accepted attitudes.
    Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    // False without rates, and after another attitude was accepted, until the attitude is again where they lead.
    bool trusted = false;
    // False for good after rates of another unit or frame.
    bool fits = true;
  };

  ControlReason compare(const VehicleState& before, const VehicleState& state) const noexcept;
  bool hasTurned(const VehicleState& before, const VehicleState& state) const noexcept;
  bool hasCrept(const VehicleState& state) const noexcept;
  bool isLedTo(const VehicleState& state) const noexcept;
  void startLed(const VehicleState& state) noexcept;
  Verdict flyLed(VehicleState& state) noexcept;
  bool standsStill(double stamp) noexcept;
  /// kNone: the sample may count.
  ControlReason unusable(const VehicleState& state) noexcept;
  void addCandidate(const VehicleState& state, bool agrees) noexcept;
  bool isElsewhere() const noexcept;
  void accept(const VehicleState& state, bool restarted, bool attitude_restarted) noexcept;

  MultirotorOptions options_;
  RepeatCheck repeat_;
  Way way_;
  Memory memory_;
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
  // True while only the attitude is wrong for sure, and that of the rates is flown; since when [s].
  bool frame_stays_ = false;
  double led_since_ = 0.0;
  // Number of refused samples in a row that agree.
  int agreeing_ = 0;
  // Number of samples in a row with the stamp of the one before.
  int same_stamp_ = 0;
  double stamp_ = 0.0;  // [s]
};

/// The report on a step by a replaced velocity or attitude: not optimal, kContradiction.
ControlReport byPositions(ControlReport report) noexcept;

/// What Verdict::contradicts says of the odometry, without a stop.
constexpr const char* kContradictionSentence =
    "the odometry's velocity does not lead from position to position, or its body rates not to its attitude: "
    "its twist must be in the body's frame, in m/s and rad/s";

}  // namespace polyfly
