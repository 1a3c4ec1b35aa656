#include "online_controller/flight/flight_supervisor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "online_controller/types/attitude.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kHoverSpeed = 0.3;  // [m/s]
// Greatest error of the height at which a take-off is done [m].
constexpr double kTakeOffTolerance = 0.1;
// A landing vehicle stands where it is so far above its sinking reference [m], and no faster than that [m/s], for so many
// control periods. An updraught that holds it up would look the same.
constexpr double kTouchdownLag = 0.3;
constexpr double kTouchdownSpeed = 0.15;
constexpr int kTouchdownPeriods = 50;
// Deceleration with which a hold stops; it holds where that ends [m/s^2].
constexpr double kBrake = 2.0;
// Time without odometry after which its next stamp may lie any time later [s].
constexpr double kLongPause = 0.5;
// Greatest number of references that a law made from other options may read.
constexpr int kMostReferences = 128;

const FlightOptions& checked(const FlightOptions& options) {
  checkFlightOptions(options);
  return options;
}

bool isFailsafe(ControlStatus status) noexcept {
  return status == ControlStatus::kLevel || status == ControlStatus::kDescend ||
         status == ControlStatus::kStopped;
}

bool isRamp(FlightState task) noexcept {
  return task == FlightState::kTakeOff || task == FlightState::kLanding;
}

}  // namespace

FlightSupervisor::FlightSupervisor(LawSwitch& law, const MultirotorOptions& vehicle,
                                   const FlightOptions& options, PilotRule pilot)
    : law_(&law),
      vehicle_(vehicle),
      options_(checked(options)),
      pilot_rule_(pilot),
      gate_(vehicle),
      preview_(static_cast<std::size_t>(std::max(law.previewLength(), kMostReferences))),
      report_(&law.report()) {
  checkOptions(vehicle);
}

FlightSituation FlightSupervisor::situation() const noexcept {
  FlightSituation result;
  result.odometry = fresh_;
  result.interrupted = interrupted_;
  result.pilot = pilot_rule_ == PilotRule::kRequired || (pilot_rule_ == PilotRule::kWhenPresent && pilot_);
  return result;
}

const char* FlightSupervisor::handle(FlightEvent event) noexcept {
  const FlightTransition next = transition(state_, event, situation());
  if (next.refusal != nullptr) return next.refusal;
  if (isRequest(event)) guided_hold_ = false;
  if (next.to != state_) {
    enter(next.to, event);
  } else if (event == FlightEvent::kHold || event == FlightEvent::kPose) {
    if (event == FlightEvent::kHold) startTask(state_, event);
    cause_ = event;
  }
  return nullptr;
}

void FlightSupervisor::enter(FlightState to, FlightEvent cause) noexcept {
  if (to == FlightState::kFailsafe) {
    interrupted_ = state_ == FlightState::kRemoteControl ? FlightState::kLanding : state_;
    holding_here_ = false;
  } else if (cause != FlightEvent::kRecovered) {
    startTask(to, cause);
    guided_hold_ = cause == FlightEvent::kGuided;
  }
  streams_ = false;
  state_ = to;
  cause_ = cause;
  ++changes_;
}

void FlightSupervisor::startTask(FlightState task, FlightEvent cause) noexcept {
  switch (task) {
    case FlightState::kTakeOff:
      law_->reset();
      law_->setDisturbance(resting_disturbance_);
      held_ = Reference{};
      held_.position = last_.position;
      held_.yaw = eulerAngles(last_.attitude.normalized()).yaw;
      ramp_ = VerticalRamp::up(held_, last_.stamp, options_.takeoff_distance, options_.takeoff_time);
      after_takeoff_.reset();
      break;
    case FlightState::kLanding:
      ramp_ = VerticalRamp::down(stop(), last_.stamp, options_.landing_speed);
      standing_ = 0;
      break;
    case FlightState::kPositionHold:
      // A pose, the end of a trajectory and where the sticks left it stand in the schedule already.
      if (cause == FlightEvent::kPose || cause == FlightEvent::kTrajectoryEnded) break;
      held_ = cause == FlightEvent::kTakeOffDone                                     ? ramp_.at(ramp_.end())
              : state_ == FlightState::kTeleoperation && cause != FlightEvent::kHold ? held_
                                                                                     : stop();
      references_.hold(held_.position, held_.yaw);
      break;
    case FlightState::kTeleoperation:
      held_ = stop();
      references_.hold(held_.position, held_.yaw);
      break;
    case FlightState::kInactive:
      references_.clear();
      break;
    case FlightState::kTrajectory:
    case FlightState::kRemoteControl:
    case FlightState::kLanded:
    case FlightState::kFailsafe:
      break;
  }
}

// Where the vehicle comes to rest when it brakes from now on.
Reference FlightSupervisor::stop() const noexcept {
  Reference reference;
  reference.position = last_.position + last_.velocity * (0.5 * last_.velocity.norm() / kBrake);
  reference.yaw = eulerAngles(last_.attitude.normalized()).yaw;
  return reference;
}

const ControlReport& FlightSupervisor::onOdometry(const VehicleState& reported, bool frame_fits) noexcept {
  VehicleState state = aligned(reported, vehicle_.heading_misalignment);
  heard_ = true;
  OdometryGate::Verdict verdict;
  verdict.refusal = ControlReason::kWrongFrame;
  if (frame_fits) verdict = gate_.check(state);
  if (!frame_fits) gate_.noteSilence();
  refused_ = verdict.refusal;
  if (verdict.refusal == ControlReason::kStale) return onSilence(state.stamp);
  if (verdict.refusal != ControlReason::kNone) {
    fresh_ = false;
    report_ = &refuse(state.stamp, verdict.refusal);
    return *report_;
  }
  contradicts_ = verdict.contradicts;
  restarted_ = verdict.restarted;
  if (restarted_) law_->forget(LawMemory::kObserver);
  references_.shift(verdict.time_jump);
  ramp_.shift(verdict.time_jump);
  last_ = state;
  fresh_ = true;
  if (!located_) checkEarlyReferences();
  if (idle_command_ == IdleCommand::kHold) handle(FlightEvent::kGuided);
  switch (state_) {
    case FlightState::kInactive:
    case FlightState::kLanded:
      report_ = idle_command_ == IdleCommand::kFollow && state_ == FlightState::kInactive
                    ? &followVehicle()
                    : &idle(state.stamp);
      break;
    case FlightState::kRemoteControl:
      report_ = &manual(state.stamp);
      law_->track(state, own_.command);
      break;
    case FlightState::kTakeOff:
    case FlightState::kPositionHold:
    case FlightState::kTrajectory:
    case FlightState::kTeleoperation:
    case FlightState::kLanding:
    case FlightState::kFailsafe:
      report_ = &fly(state);
      break;
  }
  return *report_;
}

void FlightSupervisor::checkEarlyReferences() noexcept {
  located_ = true;
  early_excess_ = references_.findExcess(last_.position, options_.reference_limits);
  if (early_excess_.limit != nullptr) dropReferences();
}

void FlightSupervisor::dropReferences() noexcept {
  references_.clear();
  if (state_ == FlightState::kRemoteControl || state_ == FlightState::kInactive) return;
  state_ = FlightState::kInactive;
  ++changes_;
}

const ControlReport& FlightSupervisor::fly(const VehicleState& state) noexcept {
  if (state_ == FlightState::kFailsafe) prepareRecovery();
  if (!makePreview(state.stamp, law_->previewNeeded())) return law_->stepWithoutReference(state.stamp);
  const ControlReport& answer = law_->step(state, preview_.data());
  if (contradicts_) own_ = byPositions(answer);
  const ControlReport& report = contradicts_ ? own_ : answer;
  if (isAnswer(report.status)) {
    handle(FlightEvent::kRecovered);
    // On the ground, where ramps begin and end, commands need not move the vehicle.
    if (!isRamp(state_)) gate_.commanded(report.command);
    watchTask(state);
  }
  if (isFailsafe(report.status)) handle(FlightEvent::kNoAnswer);
  return state_ == FlightState::kLanded ? idle(state.stamp) : report;
}

// What moved by itself must not jump to where it would have been: a descent starts anew, a take-off and what
// the sticks held end where the vehicle is.
void FlightSupervisor::prepareRecovery() noexcept {
  if (interrupted_ == FlightState::kLanding) {
    startTask(FlightState::kLanding, FlightEvent::kRecovered);
    return;
  }
  const bool goes_on = interrupted_ == FlightState::kTrajectory || interrupted_ == FlightState::kPositionHold;
  if (goes_on && options_.resume) return;
  if (interrupted_ != FlightState::kPositionHold || !holding_here_)
    startTask(FlightState::kPositionHold, FlightEvent::kRecovered);
  interrupted_ = FlightState::kPositionHold;
  holding_here_ = true;
}

void FlightSupervisor::setLaw(LawSwitch& law, const MultirotorOptions& vehicle) noexcept {
  law_ = &law;
  vehicle_ = vehicle;
  gate_.setOptions(vehicle);
  if (report_ != &own_) report_ = &law.report();
}

bool FlightSupervisor::makePreview(double time, int wanted) noexcept {
  const int count = std::min(wanted, static_cast<int>(preview_.size()));
  const double period = law_->previewPeriod();
  // A trajectory without a start begins with this sample, not where the command acts: it would be late by the lead.
  if (!isRamp(task())) references_.advance(time);
  time += law_->lead();
  if (!isRamp(task())) return references_.preview(time, period, count, preview_.data());
  for (int k = 0; k < count; ++k) preview_[static_cast<std::size_t>(k)] = ramp_.at(time + k * period);
  return true;
}

void FlightSupervisor::watchTask(const VehicleState& state) noexcept {
  const double above = state.position.z() - preview_.front().position.z();
  switch (state_) {
    case FlightState::kTrajectory:
      if (references_.ended(state.stamp)) handle(FlightEvent::kTrajectoryEnded);
      break;
    case FlightState::kTakeOff:
      if (state.stamp < ramp_.end()) break;
      if (std::abs(above) <= kTakeOffTolerance) {
        if (after_takeoff_) {
          enter(*after_takeoff_,
                *after_takeoff_ == FlightState::kTrajectory ? FlightEvent::kTrajectory : FlightEvent::kPose);
        } else {
          handle(FlightEvent::kTakeOffDone);
        }
      } else if (state.stamp > ramp_.end() + options_.takeoff_time) {
        handle(FlightEvent::kTakeOffFailed);
      }
      break;
    case FlightState::kLanding: {
      const bool stands = above >= kTouchdownLag && std::abs(state.velocity.z()) <= kTouchdownSpeed;
      standing_ = stands ? standing_ + 1 : 0;
      if (standing_ >= kTouchdownPeriods) handle(FlightEvent::kTouchdown);
      break;
    }
    case FlightState::kInactive:
    case FlightState::kPositionHold:
    case FlightState::kRemoteControl:
    case FlightState::kTeleoperation:
    case FlightState::kLanded:
    case FlightState::kFailsafe:
      break;
  }
}

const ControlReport& FlightSupervisor::refuse(double stamp, ControlReason reason) noexcept {
  const double time = std::isfinite(stamp) ? stamp : last_.stamp;
  if (state_ == FlightState::kInactive || state_ == FlightState::kLanded) return idle(time);
  if (state_ == FlightState::kRemoteControl) return manual(time);
  const ControlReport& report = law_->withoutSample(stamp, reason);
  if (isFailsafe(report.status)) handle(FlightEvent::kBadOdometry);
  return report;
}

const ControlReport& FlightSupervisor::onSilence(double now) noexcept {
  fresh_ = false;
  gate_.noteSilence();
  if (state_ == FlightState::kRemoteControl) {
    report_ = &manual(now);
  } else if (state_ == FlightState::kLanded || state_ == FlightState::kInactive) {
    report_ = &idle(now);
  } else {
    report_ = &law_->onSilence(now);
    handle(FlightEvent::kSilence);
  }
  return *report_;
}

const ControlReport& FlightSupervisor::idle(double stamp) noexcept {
  streams_ = state_ == FlightState::kInactive && idle_command_ == IdleCommand::kZeroThrust;
  if (state_ == FlightState::kInactive && !streams_) return law_->stepWithoutReference(stamp);
  own_ = ControlReport{};
  own_.stamp = stamp;
  own_.status = state_ == FlightState::kLanded ? ControlStatus::kMotorsOff : ControlStatus::kNoReference;
  own_.reason = ControlReason::kOnGround;
  return own_;
}

const ControlReport& FlightSupervisor::followVehicle() noexcept {
  std::fill(preview_.begin(), preview_.end(), stop());
  own_ = law_->step(last_, preview_.data());
  own_.status = ControlStatus::kNoReference;
  own_.reason = ControlReason::kNoReference;
  streams_ = true;
  return own_;
}

void FlightSupervisor::onAutopilot(const AutopilotReport& report) noexcept {
  autopilot_.add(report);
  idle_command_ = idleCommand(report, autopilot_, options_.offboard_stream);
  if (guided_hold_ && idle_command_ != IdleCommand::kHold) handle(FlightEvent::kGuidedEnded);
}

const ControlReport& FlightSupervisor::manual(double stamp) noexcept {
  own_ = ControlReport{};
  own_.stamp = stamp;
  own_.status = ControlStatus::kManual;
  own_.reason = ControlReason::kPilot;
  own_.command = manualCommand(sticks_, options_, vehicle_);
  return own_;
}

void FlightSupervisor::onTime(double now) noexcept {
  if (std::exchange(heard_, false)) heard_time_ = now;
  if (now - heard_time_ > kLongPause) gate_.noteSilence();
  if (!pilot_ || options_.rc_timeout <= 0.0) return;
  if (now < sticks_time_) sticks_time_ = now;  // simulated time began anew
  if (now - sticks_time_ <= options_.rc_timeout) return;
  pilot_ = false;
  handle(FlightEvent::kPilotLost);
}

bool FlightSupervisor::onRemoteControl(const RemoteControl& sticks, double now) noexcept {
  sticks_time_ = now;
  const bool was_there = pilot_;
  pilot_ = sticks.on;
  if (!sticks.on) {
    if (was_there) handle(FlightEvent::kPilotLost);
    return false;
  }
  sticks_ = sticks;
  switch (sticks.mode) {
    case RemoteControl::Mode::kManual:
      handle(FlightEvent::kManual);
      break;
    case RemoteControl::Mode::kAltitude:
      break;
    case RemoteControl::Mode::kPosition:
      handle(isActive(sticks, options_.stick_deadzone) ? FlightEvent::kSticks : FlightEvent::kSticksIdle);
      break;
  }
  if (state_ == FlightState::kTeleoperation && fresh_) {
    held_ = carrot(sticks, last_, held_, options_);
    references_.hold(held_.position, held_.yaw);
  }
  if (state_ != FlightState::kRemoteControl) return false;
  report_ = &manual(now);
  return true;
}

const char* FlightSupervisor::onReference(ReferenceTrajectory trajectory, std::optional<double> start) {
  if (trajectory.empty()) return nullptr;
  const bool is_pose = trajectory.samples().size() == 1;
  const FlightEvent event = is_pose ? FlightEvent::kPose : FlightEvent::kTrajectory;
  const FlightTransition next = transition(state_, event, situation());
  if (next.refusal != nullptr) return next.refusal;
  const ReferenceExcess excess =
      findExcess(trajectory, located_ ? &last_.position : nullptr, options_.reference_limits);
  if (excess.limit != nullptr) throw Error(describe(excess));
  references_.set(std::move(trajectory), start);
  const FlightState wanted = is_pose ? FlightState::kPositionHold : FlightState::kTrajectory;
  if (state_ == FlightState::kTakeOff) after_takeoff_ = wanted;
  if (state_ == FlightState::kFailsafe && !isRamp(interrupted_)) interrupted_ = wanted;
  handle(event);
  return nullptr;
}

void FlightSupervisor::resetObserver() noexcept {
  law_->forget(LawMemory::kObserver);
  law_->setDisturbance(Eigen::Vector3d::Zero());
}

const char* FlightSupervisor::hoverRefusal() const noexcept {
  if (!fresh_) return "there is no fresh odometry";
  if (state_ != FlightState::kPositionHold) return "it does not hold its position";
  return last_.velocity.norm() <= kHoverSpeed ? nullptr : "it moves";
}

const char* FlightSupervisor::takeOff() noexcept { return handle(FlightEvent::kTakeOff); }

const char* FlightSupervisor::land() noexcept {
  const char* refusal = handle(FlightEvent::kLand);
  if (refusal == nullptr && state_ == FlightState::kFailsafe) interrupted_ = FlightState::kLanding;
  return refusal;
}

const char* FlightSupervisor::holdPosition() noexcept { return handle(FlightEvent::kHold); }

}  // namespace polyfly
