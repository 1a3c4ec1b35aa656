#include "online_controller/laws/control_law.hpp"

#include <cmath>

namespace polyfly {

// What the reference needs leads by the lag of the model, as the laws' references of their commands do.
void ControlLaw::watchSwings(const Reference& reference, double yaw, double angle_max) noexcept {
  const MultirotorModel& model = model_.motion;
  const auto needed = [&](int axis, double gain, double time) {
    return (reference.acceleration[axis] + time * reference.jerk[axis]) / (model.gravity * gain);
  };
  const TiltAngles needs{-needed(1, model.roll_gain, model.roll_time),
                         needed(0, model.pitch_gain, model.pitch_time)};
  const AttitudeCommand& command = report_.command;
  report_.swings =
      swings_.notice(report_.stamp, bodyToWorldTilt({command.roll, command.pitch}, yaw), needs, angle_max);
}

void ControlLaw::sendInstead(const Substitute& sent) noexcept {
  if (std::isfinite(sent.stamp)) report_.stamp = sent.stamp;
  report_.status = sent.status;
  report_.reason = sent.reason;
  report_.command = sent.command;
  report_.swings = false;
  if (!sent.sampled) {
    // No parameters were assembled. What was estimated and applied still holds.
    for (AxisReport& axis : report_.axis) {
      AxisReport cleared;
      cleared.input = axis.input;
      cleared.disturbance = axis.disturbance;
      axis = cleared;
    }
  }
  if (sent.status != ControlStatus::kHoldLast) forget(LawMemory::kPlan);
}

}  // namespace polyfly
