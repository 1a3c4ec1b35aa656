#include "online_controller/laws/failsafe_policy.hpp"

#include <algorithm>

namespace polyfly {
namespace {

// Thrust of the descent as a share of the hover thrust.
constexpr double kDescendThrust = 0.95;

}  // namespace

FailsafePolicy::FailsafePolicy(const MultirotorOptions& options) : options_(options) {
  checkOptions(options);
}

void FailsafePolicy::answered() noexcept {
  has_command_ = true;
  unanswered_ = 0;
}

void FailsafePolicy::forget() noexcept {
  has_command_ = false;
  unanswered_ = 0;
}

ControlStatus FailsafePolicy::nextInSilence(AttitudeCommand& command, const TiltAngles& trim) noexcept {
  unanswered_ = std::max(unanswered_, options_.hold_periods);
  return next(command, trim);
}

ControlStatus FailsafePolicy::next(AttitudeCommand& command, const TiltAngles& trim) noexcept {
  if (!has_command_) unanswered_ = std::max(unanswered_, options_.hold_periods);
  const int level_until = options_.hold_periods + options_.level_periods;
  const int descend_until = level_until + options_.descend_periods;
  unanswered_ = std::min(unanswered_ + 1, descend_until + 1);
  if (unanswered_ <= options_.hold_periods) return ControlStatus::kHoldLast;
  has_command_ = false;
  command = levelCommand(options_, trim, unanswered_ <= level_until ? 1.0 : kDescendThrust);
  if (unanswered_ <= level_until) return ControlStatus::kLevel;
  return unanswered_ <= descend_until ? ControlStatus::kDescend : ControlStatus::kStopped;
}

AttitudeCommand levelCommand(const MultirotorOptions& options, const TiltAngles& trim,
                             double share) noexcept {
  AttitudeCommand command;
  command.roll = std::clamp(trim.roll, -options.angle_max, options.angle_max);
  command.pitch = std::clamp(trim.pitch, -options.angle_max, options.angle_max);
  command.thrust = options.mass * std::max(share * options.gravity, options.thrust_min);
  return command;
}

}  // namespace polyfly
