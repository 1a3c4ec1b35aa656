#include "online_controller/laws/multirotor_controller.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "online_controller/reference/yaw_rate.hpp"
#include "online_controller/types/valid.hpp"

namespace polyfly {
namespace {

/// Of what an axis answers: the order of the statuses, in which kLeastViolation comes before kHoldLast.
int severity(ControlStatus status) noexcept {
  constexpr int kBeforeHoldLast = 2 * static_cast<int>(ControlStatus::kHoldLast) - 1;
  return status == ControlStatus::kLeastViolation ? kBeforeHoldLast : 2 * static_cast<int>(status);
}

ControlReason reasonOf(const AxisReport& report, ControlStatus status) noexcept {
  if (status == ControlStatus::kHoldLast || status == ControlStatus::kLeastViolation)
    return ControlReason::kOutsidePartition;
  if (status == ControlStatus::kClipped) return ControlReason::kOutsideBox;
  // The axis has its answer here, from the map or else from the online law.
  switch (report.lookup) {
    case LookupStatus::kOutsideBox:
      return ControlReason::kOutsideBox;
    case LookupStatus::kOutsidePartition:
      return ControlReason::kOutsidePartition;
    case LookupStatus::kInside:
    case LookupStatus::kNotFinite:
      break;
  }
  return ControlReason::kNone;
}

AxisReference along(const Reference& reference, const Eigen::Vector3d& disturbance, int axis) noexcept {
  return {reference.position[axis], reference.velocity[axis], reference.acceleration[axis],
          reference.jerk[axis], disturbance[axis]};
}

}  // namespace

void MultirotorController::resetObservers() noexcept {
  for (Axis& axis : axes_) axis.reset();
}

const ControlReport& MultirotorController::step(const VehicleState& state,
                                                const Reference& reference) noexcept {
  preview_ = nullptr;
  return answer(state, reference);
}

const ControlReport& MultirotorController::step(const VehicleState& state,
                                                const Reference* preview) noexcept {
  preview_ = previewLength() > 1 ? preview : nullptr;
  return answer(state, *preview);
}

const ControlReport& MultirotorController::answer(const VehicleState& state,
                                                  const Reference& reference) noexcept {
  if (std::isfinite(state.stamp)) report_.stamp = state.stamp;
  if (!isValid(state)) return cannotAnswer(ControlReason::kNotFinite);
  const Measured measured = measure(state);
  observe(state, measured);
  if (!readStages() || !isValid(reference)) return cannotAnswer(ControlReason::kNotFinite);

  if (isAnswer(report_.status) && !clock_.due(state.stamp)) {
    send(measured.tilt, measured.yaw, reference);
    return report_;
  }
  integrator_.update(state, reference, report_);
  ControlReason reason = ControlReason::kNone;
  const ControlStatus worst = evaluate(measured, reference, reason);
  if (worst == ControlStatus::kHoldLast) return cannotAnswer(reason);
  send(measured.tilt, measured.yaw, reference);
  clock_.decided(state.stamp);
  report_.status = worst;
  report_.reason = reason;
  // The answers of a minimum-peak law go from bound to bound in flights that are well.
  if (!axes_[0].problem().minimum_peak) watchSwings(reference, measured.yaw, options_.angle_max);
  return report_;
}

bool MultirotorController::readStages() noexcept {
  if (preview_ == nullptr) return true;
  bool valid = true;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (int k = 0; k < previewLength(); ++k) {
      const Reference& read = preview_[k];
      axes_[i].setStage(
          k, {read.position[row], read.velocity[row], read.acceleration[row], read.jerk[row], 0.0});
    }
    valid = valid && axes_[i].areStagesValid();
  }
  return valid;
}

// The worst status of the axes, and its reason. Unless each has an answer the inputs are left alone.
ControlStatus MultirotorController::evaluate(const Measured& measured, const Reference& reference,
                                             ControlReason& reason) noexcept {
  const Eigen::Vector3d integral = integrator_.disturbance();
  const std::array<AxisReference, 3> wanted{along(reference, integral, 0), along(reference, integral, 1),
                                            along(reference, integral, 2)};
  const std::array<double, 3> offsets = inputOffsets(measured, reference, wanted);
  for (Axis& axis : axes_) axis.aim(preview_ != nullptr);
  ControlStatus worst = ControlStatus::kOptimal;
  report_.iterations = 0;
  std::array<AxisReport, 3>& reports = report_.axis;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const ControlStatus status =
        axes_[i].evaluate(measured.axes[i], wanted[i], inputs_[i], offsets[i], reports[i]);
    report_.iterations += reports[i].iterations;
    report_.force_left[static_cast<Eigen::Index>(i)] = options_.mass * axes_[i].constantLeft();
    const bool worse = severity(status) > severity(worst);
    if (worse || reason == ControlReason::kNone) reason = reasonOf(reports[i], status);
    if (worse) worst = status;
  }
  if (worst == ControlStatus::kHoldLast) return worst;
  for (std::size_t i = 0; i < axes_.size(); ++i) inputs_[i] = reports[i].input - offsets[i];
  return worst;
}

// Rises from 0 to 1 while the greater of the goals goes from half to three quarters of its bounds.
double MultirotorController::nearBounds(const std::array<double, 2>& goals) const noexcept {
  double share = 0.0;
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const double bound = goals[i] < 0.0 ? -axes_[i].inputLower() : axes_[i].inputUpper();
    if (bound > 0.0) share = std::max(share, std::abs(goals[i]) / bound);
  }
  return std::clamp((share - 0.5) / 0.25, 0.0, 1.0);
}

// The laws bound the input of the model, but the bounds are meant for the command. Offsets convert one into the other
// at the reference, for two reasons. Eq. 41 divides the input by T / g. And in a turn, where the body yaws together with
// its tilt, the input of the model leads the tilt by `turn`, which the command does not need. The share of this lead
// that makes the inputs smallest is left out. There are no offsets while the goals lie within half of the bounds.
std::array<double, 3> MultirotorController::inputOffsets(
    const Measured& measured, const Reference& reference,
    const std::array<AxisReference, 3>& wanted) const noexcept {
  if (axes_[0].problem().minimum_peak) return {};  // its promise holds for the model's input
  // On the ground the command may be without thrust.
  const double thrust =
      std::clamp(report_.command.thrust / options_.mass, options_.thrust_min, options_.thrust_max);
  const double scale = thrust / options_.gravity;
  const std::array<double, 2> goal{axes_[0].inputReference(wanted[0]), axes_[1].inputReference(wanted[1])};
  const double near = nearBounds(goal);
  if (near == 0.0) return {};
  const TiltAngles turn =
      bodyToWorldTilt(trim_.turn(measured.tilt, yawRate(options_, reference, measured.yaw)), measured.yaw);
  const std::array<double, 2> turned{scale * turn.pitch, scale * turn.roll};
  const double lead = -(turned[0] * goal[0] + turned[1] * goal[1]);
  const double square = turned[0] * turned[0] + turned[1] * turned[1];
  const double share = lead > 0.0 && square > 0.0 ? std::min(1.0, lead / square) : 0.0;
  std::array<double, 3> offsets{};
  for (std::size_t i = 0; i < goal.size(); ++i) {
    // A goal beyond the limits asks for no more than they allow.
    const double within =
        std::clamp(goal[i] + share * turned[i], scale * axes_[i].inputLower(), scale * axes_[i].inputUpper());
    offsets[i] = near * (share * turned[i] + (1.0 / scale - 1.0) * within);
  }
  return offsets;
}

// The angle of an axis is the specific force of the rotors over g: the tilt times T / g, as Eq. 41 has it.
// Taken for the tilt itself it would not obey the lag of the model, and one disturbance cannot explain two
// errors: some centimetres would be left in a wind that changes the thrust.
MultirotorController::Measured MultirotorController::measure(const VehicleState& state) const noexcept {
  const double share = report_.command.thrust / (options_.mass * options_.gravity);
  const EulerAngles angles = eulerAngles(state.attitude.normalized());
  const TiltAngles tilt{angles.roll, angles.pitch};
  const TiltAngles world = bodyToWorldTilt(tilt, angles.yaw);
  const TiltAngles rate = worldTiltRate(angles, state.angular_velocity);
  return {tilt,
          angles.yaw,
          {{{state.position.x(), state.velocity.x(), share * world.pitch, share * rate.pitch},
            {state.position.y(), state.velocity.y(), share * world.roll, share * rate.roll},
            {state.position.z(), state.velocity.z(), 0.0, 0.0}}}};
}

void MultirotorController::track(const VehicleState& state, const AttitudeCommand& sent) noexcept {
  if (!isValid(state)) return;
  const Measured measured = measure(state);
  observe(state, measured);
  clock_.reset();
  feed_forward_ = {};
  correct(state, sent);
  followed_ = {};
}

void MultirotorController::correct(const VehicleState& state, const AttitudeCommand& sent) noexcept {
  const Measured measured = measure(state);
  // Eq. 41 and 40 backwards.
  const double thrust = sent.thrust / options_.mass;
  const TiltAngles world = bodyToWorldTilt(forceAngles(sent, measured.tilt), measured.yaw);
  applied_ = {world.pitch, world.roll, thrust * tiltCosine(measured.tilt) - options_.gravity};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    inputs_[i] = std::clamp(applied_[i], axes_[i].inputLower(), axes_[i].inputUpper());
  }
  report_.command = sent;
}

void MultirotorController::observe(const VehicleState& state, const Measured& measured) noexcept {
  const int periods = beginSample(state.stamp);
  if (periods == 0) return;
  const FlownReference is_flown = flown(followed_, measured.tilt, state.velocity);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    std::optional<double> velocity;
    if (is_flown.velocity) velocity = (*is_flown.velocity)(static_cast<Eigen::Index>(i));
    axes_[i].observe(measured.axes[i], applied_[i], periods, velocity);
  }
  observeTrim(measured.tilt, periods, is_flown);
  report_.found_drag = {axes_[0].foundDrag(), axes_[1].foundDrag()};
}

void MultirotorController::send(const TiltAngles& measured_tilt, double yaw,
                                const Reference& reference) noexcept {
  // The accelerations of Eq. 41 are zero here: they are in the targets already, see Axis::target. The tilt is
  // divided by the thrust after its limits, because that is the thrust which will act.
  const double demanded = compensatedThrust(inputs_[2], measured_tilt, options_.gravity, 0.0);
  const double thrust = std::clamp(demanded, options_.thrust_min, options_.thrust_max);
  const TiltAngles desired = worldToBodyTilt({inputs_[1], inputs_[0]}, yaw);
  const TiltAngles tilt = compensatedTilt(desired, thrust, options_.gravity, 0.0, 0.0);
  AttitudeCommand& command = report_.command;
  command.yaw_rate = yawRate(options_, reference, yaw);
  follow(reference, thrust, yaw);
  const TiltAngles by = added(measured_tilt, command.yaw_rate);
  const TiltAngles trimmed{tilt.roll + by.roll, tilt.pitch + by.pitch};
  command.roll = std::clamp(trimmed.roll, -options_.angle_max, options_.angle_max);
  command.pitch = std::clamp(trimmed.pitch, -options_.angle_max, options_.angle_max);
  command.thrust = options_.mass * thrust;

  // What the limits left of the inputs, Eq. 41 and 40 backwards: the observer must not take a limit for wind.
  applied_ = inputs_;
  if (thrust != demanded) applied_[2] = thrust * tiltCosine(measured_tilt) - options_.gravity;
  if (command.roll != trimmed.roll || command.pitch != trimmed.pitch) {
    const TiltAngles world = bodyToWorldTilt(forceAngles(command, measured_tilt), yaw);
    applied_[0] = world.pitch;
    applied_[1] = world.roll;
  }
}

// The axes' angles are T / g times the tilt. Euler angles turn with the body besides.
void MultirotorController::follow(const Reference& reference, double thrust, double yaw) noexcept {
  const double share = options_.gravity / thrust;
  const double turn = report_.command.yaw_rate;
  followed_.whole_tilt = worldToBodyTilt({share * axes_[1].goal().angle, share * axes_[0].goal().angle}, yaw);
  const Eigen::Vector3d nothing = Eigen::Vector3d::Zero();
  const AxisTarget forward = axes_[0].undisturbedGoal(along(reference, nothing, 0));
  const AxisTarget across = axes_[1].undisturbedGoal(along(reference, nothing, 1));
  FollowedTilt& tilt = followed_.tilt;
  tilt.angle = worldToBodyTilt({share * across.angle, share * forward.angle}, yaw);
  tilt.rate = worldToBodyTilt({share * across.rate, share * forward.rate}, yaw);
  tilt.rate.roll += turn * tilt.angle.pitch;
  tilt.rate.pitch -= turn * tilt.angle.roll;
  followed_.velocity = reference.velocity;
  feed_forward_ = trim_.feedForward(tilt, turn);
}

// The tilt stays in the world-aligned frame, in which the axes are modelled, while the body yaws.
TiltAngles MultirotorController::added(const TiltAngles& tilt, double yaw_rate) const noexcept {
  const TiltAngles by = trim_.added(tilt, yaw_rate, 1.0);
  return {by.roll + feed_forward_.roll, by.pitch + feed_forward_.pitch};
}

// Eq. 41 backwards: the tilt that a command asks for, times T / g.
TiltAngles MultirotorController::forceAngles(const AttitudeCommand& command,
                                             const TiltAngles& measured_tilt) const noexcept {
  const double scale = command.thrust / options_.mass / options_.gravity;
  const TiltAngles by = added(measured_tilt, command.yaw_rate);
  return {(command.roll - by.roll) * scale, (command.pitch - by.pitch) * scale};
}

const ControlReport& MultirotorController::cannotAnswer(ControlReason reason) noexcept {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    AxisReport& axis = report_.axis[i];
    // What is applied is the last command, not what this sample could not answer.
    axis.input = inputs_[i];
    axis.region = -1;
    if (reason != ControlReason::kOutsidePartition) {  // no parameters were assembled
      axis.size = 0;
      axis.theta.fill(0.0);
      axis.lookup = LookupStatus::kNotFinite;
      axis.outside_parameter = -1;
    }
  }
  return withoutAnswer(reason);
}

void MultirotorController::setDisturbance(const Eigen::Vector3d& disturbance) noexcept {
  resetTrim();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    axes_[i].setDisturbance(disturbance(static_cast<Eigen::Index>(i)));
  }
}

void MultirotorController::forget(LawMemory what) noexcept {
  if (what == LawMemory::kAll) clock_.reset();
  EstimatingLaw::forget(what);
}

void MultirotorController::forgetPlan() noexcept {
  followed_ = {};
  for (AxisReport& axis : report_.axis) axis.input = 0.0;
  inputs_.fill(0.0);
  applied_.fill(0.0);
  applied_[2] = report_.command.thrust / options_.mass - options_.gravity;
}

}  // namespace polyfly
