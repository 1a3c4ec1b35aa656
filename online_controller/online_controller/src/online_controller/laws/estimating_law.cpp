#include "online_controller/laws/estimating_law.hpp"

#include <algorithm>

#include "online_controller/laws/failsafe_policy.hpp"

namespace polyfly {
namespace {

/// A command to be repeated meets the limits that hold now.
void limit(const MultirotorOptions& options, AttitudeCommand& command) noexcept {
  command.roll = std::clamp(command.roll, -options.angle_max, options.angle_max);
  command.pitch = std::clamp(command.pitch, -options.angle_max, options.angle_max);
  command.yaw_rate = std::clamp(command.yaw_rate, -options.yaw_rate_max, options.yaw_rate_max);
  command.thrust =
      std::clamp(command.thrust, options.mass * options.thrust_min, options.mass * options.thrust_max);
}

}  // namespace

EstimatingLaw::EstimatingLaw(const LawTiming& timing, const VehicleModel& model,
                             const MultirotorOptions& options, const TiltModel& tilt,
                             const MultirotorOptions& offsets)
    : ControlLaw(timing, model),
      options_(options),
      trim_(tilt, offsets),
      integrator_(offsets),
      line_(options.control_period) {}

void EstimatingLaw::forgetAll() noexcept {
  resetObservers();
  trim_.reset();
  integrator_.reset();
  line_.restart();
  report_ = ControlReport{};
  report_.level_trim = trim_.level();
  report_.command = levelCommand(options_, report_.level_trim);
  forgetPlan();
}

void EstimatingLaw::forget(LawMemory what) noexcept {
  switch (what) {
    case LawMemory::kAll:
      forgetAll();
      break;
    case LawMemory::kPlan:
      forgetPlan();
      break;
    case LawMemory::kObserver:
      line_.restart();
      break;
    case LawMemory::kLoops:
      trim_.forgetLoops();
      break;
    case LawMemory::kIntegral:
      integrator_.reset();
      break;
  }
}

int EstimatingLaw::beginSample(double stamp) noexcept {
  const SampleLine::Step step = line_.next(stamp);
  if (step.is_other_flight) {
    resetObservers();
    trim_.reset();
  }
  return step.periods;
}

void EstimatingLaw::observeTrim(const TiltAngles& measured, int periods,
                                const FlownReference& is_flown) noexcept {
  trim_.update(measured, report_.command, periods, is_flown.tilt);
  followed_ = {};
  report_.trim = trim_.angles();
  report_.level_trim = trim_.level();
  report_.coupling = trim_.coupling();
  report_.loops = trim_.loops();
}

void EstimatingLaw::resetTrim() noexcept {
  trim_.reset();
  report_.level_trim = trim_.level();
}

void EstimatingLaw::transferEstimates(const EstimatingLaw& from) noexcept {
  trim_.transferState(from.trim_);
  integrator_.transferState(from.integrator_);
  line_.transferState(from.line_);
  followed_ = from.followed_;
  swings_ = from.swings_;
  report_ = from.report_;
  report_.level_trim = trim_.level();
  limit(options_, report_.command);
}

}  // namespace polyfly
