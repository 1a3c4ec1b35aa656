#include "online_controller/estimation/delay_predictor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "online_controller/types/valid.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kGreatestDelay = 0.5;  // [s]
constexpr double kLongestStep = 0.02;   // of the integration [s]

double checkedDelay(double delay, const MultirotorOptions& options) {
  if (!(delay >= 0.0 && delay <= kGreatestDelay))
    throw Error("vehicle/delay: must be 0 to 0.5 s, got " + std::to_string(delay));
  const double most = (DelayPredictor::kMostCommands - 1) * options.control_period;
  if (delay > most) {
    throw Error("vehicle/delay: must be at most " + std::to_string(DelayPredictor::kMostCommands - 1) +
                " times controller/control_period, " + std::to_string(most) + " s, got " +
                std::to_string(delay));
  }
  return delay;
}

// What the predictor does not know of the disturbance costs the delay times that in velocity, while its noise costs little
// for the same reason. So it follows faster than the observers of the laws.
MultirotorOptions following(MultirotorOptions options) {
  constexpr double kDrift = 1.0;  // in a second [m/s^2]
  options.disturbance_drift = std::max(options.disturbance_drift, kDrift * std::sqrt(options.control_period));
  return options;
}

TiltModel loopsOf(const MultirotorModel& model) {
  return {model.roll_gain, model.roll_time, model.pitch_gain, model.pitch_time};
}

Eigen::Quaterniond attitudeOf(double roll, double pitch, double yaw) noexcept {
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
}

bool isSame(const AttitudeCommand& a, const AttitudeCommand& b) noexcept {
  return a.roll == b.roll && a.pitch == b.pitch && a.yaw_rate == b.yaw_rate && a.thrust == b.thrust;
}

}  // namespace

DelayPredictor::DelayPredictor(const MultirotorModel& model, double delay, const MultirotorOptions& options)
    : model_(model),
      delay_(checkedDelay(delay, options)),
      mass_(options.mass),
      period_(options.control_period),
      hover_{options.roll_trim, options.pitch_trim, 0.0, options.mass * options.gravity},
      force_(model, following(options)),
      trim_(loopsOf(model), options) {
  model_.gravity = options.gravity;
  reset();
}

void DelayPredictor::reset() noexcept {
  force_.reset();
  trim_.reset();
  observing_ = false;
  first_ = 0;
  count_ = 1;
  sent_[0] = {-std::numeric_limits<double>::infinity(), hover_};
}

void DelayPredictor::sent(double stamp, const AttitudeCommand& command) noexcept {
  if (!std::isfinite(stamp) || isSame(at(count_ - 1).command, command)) return;
  while (count_ > 0 && !(at(count_ - 1).stamp < stamp)) --count_;
  if (count_ == kMostCommands) {
    first_ = (first_ + 1) % kMostCommands;
    --count_;
  }
  sent_[static_cast<std::size_t>((first_ + count_) % kMostCommands)] = {stamp, command};
  ++count_;
}

template <class Use>
void DelayPredictor::visitSent(double from, double until, Use&& use) const noexcept {
  for (int i = 0; i < count_; ++i) {
    const double end = i + 1 < count_ ? std::min(at(i + 1).stamp, until) : until;
    if (!(end > from)) continue;
    use(at(i).command, end - from);
    from = end;
  }
}

AttitudeCommand DelayPredictor::meanSent(double from, double until) const noexcept {
  AttitudeCommand mean;
  visitSent(from, until, [&](const AttitudeCommand& command, double duration) {
    const double share = duration / (until - from);
    mean.roll += share * command.roll;
    mean.pitch += share * command.pitch;
    mean.yaw_rate += share * command.yaw_rate;
    mean.thrust += share * command.thrust;
  });
  return mean;
}

void DelayPredictor::observe(const VehicleState& state, const EulerAngles& angles) noexcept {
  const double late = (state.stamp - observed_until_) / period_;
  int periods = ForceObserver::kMaxPeriods + 1;  // starts on the sample
  if (observing_ && late < -0.5) {
    force_.reset();  // time went back: another flight
    trim_.reset();
  } else if (observing_ && late < ForceObserver::kMaxPeriods + 0.5) {
    periods = static_cast<int>(std::lround(late));
  }
  if (periods == 0) return;
  const bool continues = periods <= ForceObserver::kMaxPeriods;
  const double since = continues ? std::min(last_stamp_, state.stamp) : state.stamp;
  observed_until_ = continues ? observed_until_ + periods * period_ : state.stamp;
  last_stamp_ = state.stamp;
  observing_ = true;
  const AttitudeCommand acted = since < state.stamp
                                    ? meanSent(since - delay_, state.stamp - delay_)
                                    : meanSent(state.stamp - delay_ - period_, state.stamp - delay_);
  force_.update(state, acted.thrust / mass_, periods);
  trim_.update({angles.roll, angles.pitch}, acted, periods);
}

VehicleState DelayPredictor::ahead(const VehicleState& measured) noexcept {
  if (delay_ == 0.0 || !isValid(measured)) return measured;
  const EulerAngles angles = eulerAngles(measured.attitude.normalized());
  observe(measured, angles);
  MultirotorState x;
  x << measured.position, measured.velocity, angles.roll, angles.pitch;
  double yaw = angles.yaw;
  StageStep step;
  visitSent(measured.stamp - delay_, measured.stamp, [&](const AttitudeCommand& command, double duration) {
    const int parts = static_cast<int>(std::ceil(duration / kLongestStep));
    for (int i = 0; i < parts; ++i) {
      const TiltAngles by = trim_.added({x(6), x(7)}, command.yaw_rate, 0.0);
      const MultirotorInput u(command.roll - by.roll, command.pitch - by.pitch, command.thrust / mass_);
      integrateStage(model_, duration / parts, {yaw, command.yaw_rate, force_.disturbance()}, x, u, step);
      x = step.next;
      yaw += command.yaw_rate * duration / parts;
    }
  });
  VehicleState result = measured;
  result.position = x.head<3>();
  result.velocity = x.segment<3>(3);
  result.attitude = attitudeOf(x(6), x(7), yaw);
  return result;
}

void DelayPredictor::transferState(const DelayPredictor& from) noexcept {
  sent_ = from.sent_;
  first_ = from.first_;
  count_ = from.count_;
  if (from.delay_ == 0.0) return;
  force_.transferState(from.force_);
  trim_.transferState(from.trim_);
  observed_until_ = from.observed_until_;
  last_stamp_ = from.last_stamp_;
  observing_ = from.observing_;
}

}  // namespace polyfly
