#pragma once

#include <optional>
#include <vector>

#include "online_controller/estimation/odometry_gate.hpp"
#include "online_controller/flight/autopilot.hpp"
#include "online_controller/flight/flight_state.hpp"
#include "online_controller/flight/remote_control.hpp"
#include "online_controller/laws/law_switch.hpp"
#include "online_controller/reference/reference_schedule.hpp"
#include "online_controller/reference/vertical_ramp.hpp"
#include "online_controller/types/flight_options.hpp"

namespace polyfly {

/// Whether a remote control must have handed the vehicle over before anything else may start it: always,
/// never, or when one was heard of.
enum class PilotRule { kRequired, kNotRequired, kWhenPresent };

/// One flight: the state machine around the control laws. It decides which reference the law tracks, refuses
/// odometry that cannot be, and says why it does what it does.
///
/// onOdometry, onSilence, onTime, onRemoteControl and the requests never throw, allocate, lock, log or read a
/// clock; onReference allocates and may throw.
class FlightSupervisor {
 public:
  /// Keeps a reference to `law`. Throws Error naming an option out of its range.
  FlightSupervisor(LawSwitch& law, const MultirotorOptions& vehicle, const FlightOptions& options,
                   PilotRule pilot = PilotRule::kWhenPresent);

  /// Other laws from the next step on, made from other options. They have the state of those before, which may
  /// be freed then.
  void setLaw(LawSwitch& law, const MultirotorOptions& vehicle) noexcept;

  /// One control period. `frame_fits`: the odometry's frame is the one agreed. All else is told of the vehicle with the
  /// heading of vehicle/heading_misalignment.
  const ControlReport& onOdometry(const VehicleState& reported, bool frame_fits = true) noexcept;

  /// One control period of silence, which has been long enough, at time `now` [s].
  const ControlReport& onSilence(double now) noexcept;

  /// The time [s], in every control period: a remote control that has gone silent is noticed here, and a pause of the
  /// odometry.
  void onTime(double now) noexcept;

  /// What the autopilot says, in every control period before onOdometry or onSilence. Without it nothing is known.
  void onAutopilot(const AutopilotReport& report) noexcept;

  /// The sticks at time `now` [s]. True when the command of report() is to be sent: manual mode.
  bool onRemoteControl(const RemoteControl& sticks, double now) noexcept;

  /// A new reference; see ReferenceSchedule::set. Answers why it is refused, nullptr when it is taken. Throws
  /// Error where it asks for more than the limits. What comes before the first odometry is judged by it:
  /// see earlyExcess().
  const char* onReference(ReferenceTrajectory trajectory, std::optional<double> start);

  /// What of the references that came before the first odometry was too far from it: all were dropped then.
  const ReferenceExcess& earlyExcess() const noexcept { return early_excess_; }

  /// No reference is left; nothing has started the flight. For the time before the first odometry.
  void dropReferences() noexcept;

  /// Whether odometry was ever accepted.
  bool isLocated() const noexcept { return located_; }

  /// Requests; they answer why they are refused, nullptr when they are granted.
  const char* takeOff() noexcept;
  const char* land() noexcept;
  const char* holdPosition() noexcept;

  /// Why a calibration makes no sense now, nullptr when the vehicle hovers.
  const char* hoverRefusal() const noexcept;

  /// What the law's observer begins a take-off with: found by a calibration at hover [m/s^2].
  void setRestingDisturbance(const Eigen::Vector3d& disturbance) noexcept {
    resting_disturbance_ = disturbance;
  }

  void resetIntegrator() noexcept { law_->forget(LawMemory::kIntegral); }

  /// The law's observer forgets what it knows of the disturbance and goes on from the next sample.
  void resetObserver() noexcept;

  FlightState state() const noexcept { return state_; }
  /// Event of the last change of the state.
  FlightEvent cause() const noexcept { return cause_; }
  /// Number of changes of the state so far.
  unsigned changes() const noexcept { return changes_; }
  /// Reason why the last odometry was refused; kNone: accepted.
  ControlReason lastRefusal() const noexcept { return refused_; }
  /// Whether the last odometry was a restart, see OdometryGate::Verdict.
  bool restarted() const noexcept { return restarted_; }
  const ControlReport& report() const noexcept { return *report_; }

  /// Whether the command of report() is to be sent.
  bool sends() const noexcept {
    return report_->status != ControlStatus::kStopped &&
           (report_->status != ControlStatus::kNoReference || streams_);
  }

  /// What the law tracked in its last step, lead() after the sample's time and at each previewPeriod() after that:
  /// previewNeeded() of them.
  const std::vector<Reference>& preview() const noexcept { return preview_; }

  /// The same up to previewLength(), for those who watch; nothing without a reference.
  const std::vector<Reference>& wholePreview() noexcept {
    makePreview(last_.stamp, law_->previewLength());
    return preview_;
  }

 private:
  FlightSituation situation() const noexcept;
  const char* handle(FlightEvent event) noexcept;
  void enter(FlightState to, FlightEvent cause) noexcept;
  FlightState task() const noexcept { return state_ == FlightState::kFailsafe ? interrupted_ : state_; }
  void prepareRecovery() noexcept;

  const ControlReport& refuse(double stamp, ControlReason reason) noexcept;
  const ControlReport& idle(double stamp) noexcept;
  const ControlReport& followVehicle() noexcept;
  const ControlReport& manual(double stamp) noexcept;
  const ControlReport& fly(const VehicleState& state) noexcept;
  void watchTask(const VehicleState& state) noexcept;
  // References for a sample of that time.
  bool makePreview(double time, int count) noexcept;
  void checkEarlyReferences() noexcept;
  Reference stop() const noexcept;
  void startTask(FlightState task, FlightEvent cause) noexcept;

  LawSwitch* law_;  // not owned
  MultirotorOptions vehicle_;
  FlightOptions options_;
  PilotRule pilot_rule_;

  FlightState state_ = FlightState::kInactive;
  // State that the failsafe interrupted.
  FlightState interrupted_ = FlightState::kInactive;
  // True when the recovery from this failsafe has already set a pose to hold.
  bool holding_here_ = false;
  FlightEvent cause_ = FlightEvent::kTouchdown;
  unsigned changes_ = 0;

  OdometryGate gate_;
  // True when odometry came since the last onTime.
  bool heard_ = false;
  // Time of the first onTime after the last odometry [s].
  double heard_time_ = 0.0;
  ControlReason refused_ = ControlReason::kNone;
  bool restarted_ = false;
  // True while a part of the odometry is replaced, see OdometryGate::Verdict.
  bool contradicts_ = false;
  // Last accepted odometry.
  VehicleState last_;
  // True after the first accepted odometry.
  bool located_ = false;
  // True when the last odometry was accepted, and there was no silence since.
  bool fresh_ = false;

  ReferenceSchedule references_;
  ReferenceExcess early_excess_;
  // State that follows the take-off, from a reference received meanwhile.
  std::optional<FlightState> after_takeoff_;
  VerticalRamp ramp_;
  Eigen::Vector3d resting_disturbance_ = Eigen::Vector3d::Zero();
  // Pose that the sticks move.
  Reference held_;
  // Number of control periods in which a landing vehicle seemed to stand.
  int standing_ = 0;

  AutopilotHistory autopilot_;
  // What is sent while nothing has started the flight.
  IdleCommand idle_command_ = IdleCommand::kNothing;
  // True when kGuided began what the vehicle does, and nothing else was asked for since.
  bool guided_hold_ = false;
  // True when the last command without a reference is for an autopilot that is not guided yet.
  bool streams_ = false;

  RemoteControl sticks_;
  double sticks_time_ = 0.0;  // [s]
  // True when a remote control is on and heard.
  bool pilot_ = false;

  std::vector<Reference> preview_;
  // Report on what is sent without a law.
  ControlReport own_;
  const ControlReport* report_;
};

}  // namespace polyfly
