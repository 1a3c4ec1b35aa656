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
// for the same reason. So it follows faster than the observers of the laws. With half as much drift again the nonlinear law
// comes near to oscillating. That was over a loop that counts as a lag of 0.09 s and a delay of 0.18 s.
MultirotorOptions following(MultirotorOptions options) {
  constexpr double kDrift = 0.2;  // in a second [m/s^2]
  options.adapt_model = false;
  options.disturbance_drift = std::max(options.disturbance_drift, kDrift * std::sqrt(options.control_period));
  return options;
}

TiltModel loopsOf(const MultirotorModel& model) {
  return {model.roll_gain, model.roll_time, model.pitch_gain, model.pitch_time};
}

/// The inverse of eulerRates.
Eigen::Vector3d bodyRates(const EulerAngles& angles, const EulerAngles& rates) noexcept {
  const double sine = std::sin(angles.roll), cosine = std::cos(angles.roll);
  const double turn = std::cos(angles.pitch) * rates.yaw;
  return {rates.roll - std::sin(angles.pitch) * rates.yaw, cosine * rates.pitch + sine * turn,
          cosine * turn - sine * rates.pitch};
}

bool isSame(const AttitudeCommand& a, const AttitudeCommand& b) noexcept {
  return a.roll == b.roll && a.pitch == b.pitch && a.yaw_rate == b.yaw_rate && a.thrust == b.thrust;
}

}  // namespace

DelayPredictor::DelayPredictor(const VehicleModel& model, const MultirotorOptions& options)
    : model_(model),
      delay_(checkedDelay(options.delay > 0.0 ? options.delay : model.delay, options)),
      mass_(options.mass),
      period_(options.control_period),
      hover_{options.roll_trim, options.pitch_trim, 0.0, options.mass * options.gravity},
      force_(model.motion, following(options)),
      trim_(loopsOf(model.motion), following(options)),
      line_(options.control_period) {
  model_.motion.gravity = options.gravity;
  reset();
}

void DelayPredictor::reset() noexcept {
  force_.reset();
  trim_.reset();
  line_.restart();
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
  const SampleLine::Step step = line_.next(state.stamp);
  if (step.is_other_flight) {
    force_.reset();
    trim_.reset();
  }
  if (step.periods == 0) return;
  const double since = step.continues() ? std::min(last_stamp_, state.stamp) : state.stamp;
  last_stamp_ = state.stamp;
  const AttitudeCommand acted = since < state.stamp
                                    ? meanSent(since - delay_, state.stamp - delay_)
                                    : meanSent(state.stamp - delay_ - period_, state.stamp - delay_);
  force_.update(state, acted.thrust / mass_, step.periods);
  trim_.update({angles.roll, angles.pitch}, acted, step.periods);
}

// The command with which a lag of first order ends where this loop of second order does, by the trapezoidal rule: it is
// stable for any loop.
double DelayPredictor::asLag(const AngleLoop& loop, const Lag& lag, double command, double duration,
                             double angle, double& rate) noexcept {
  if (loop.stiffness == 0.0) return command;
  const double half = 0.5 * duration;
  const double pull = half * loop.damping + half * half * loop.stiffness;
  const double before = rate;
  rate = ((1.0 - pull) * rate + duration * loop.stiffness * (lag.gain * command - angle)) / (1.0 + pull);
  const double moved = half * (before + rate);
  const double risen = -std::expm1(-duration / lag.time);
  return (moved / risen + angle) / lag.gain;
}

void DelayPredictor::advance(const AttitudeCommand& command, double duration, Motion& motion) const noexcept {
  const MultirotorModel& model = model_.motion;
  const int parts = static_cast<int>(std::ceil(duration / kLongestStep));
  const double part = duration / parts;
  StageStep step;
  for (int i = 0; i < parts; ++i) {
    MultirotorState& x = motion.x;
    const TiltAngles by = trim_.added({x(6), x(7)}, command.yaw_rate, 0.0);
    const MultirotorInput u(asLag(model_.roll, {model.roll_gain, model.roll_time}, command.roll - by.roll,
                                  part, x(6), motion.rate.roll),
                            asLag(model_.pitch, {model.pitch_gain, model.pitch_time},
                                  command.pitch - by.pitch, part, x(7), motion.rate.pitch),
                            command.thrust / mass_);
    integrateStage(model, part, {motion.yaw, command.yaw_rate, force_.disturbance()}, x, u, step);
    x = step.next;
    motion.yaw += command.yaw_rate * part;
  }
}

VehicleState DelayPredictor::ahead(const VehicleState& measured) noexcept {
  if (delay_ == 0.0 || !isValid(measured)) return measured;
  const EulerAngles angles = eulerAngles(measured.attitude.normalized());
  observe(measured, angles);
  const EulerAngles rates = eulerRates(angles, measured.angular_velocity);
  Motion motion{MultirotorState(), angles.yaw, {rates.roll, rates.pitch}};
  motion.x << measured.position, measured.velocity, angles.roll, angles.pitch;
  visitSent(measured.stamp - delay_, measured.stamp,
            [&](const AttitudeCommand& command, double duration) { advance(command, duration, motion); });
  VehicleState result = measured;
  result.position = motion.x.head<3>();
  result.velocity = motion.x.segment<3>(3);
  result.attitude = attitudeOf({motion.x(6), motion.x(7), motion.yaw});
  if (model_.roll.stiffness > 0.0 || model_.pitch.stiffness > 0.0) {
    result.angular_velocity =
        bodyRates({motion.x(6), motion.x(7), motion.yaw}, {motion.rate.roll, motion.rate.pitch, rates.yaw});
  }
  return result;
}

void DelayPredictor::transferState(const DelayPredictor& from) noexcept {
  sent_ = from.sent_;
  first_ = from.first_;
  count_ = from.count_;
  if (from.delay_ == 0.0) return;
  force_.transferState(from.force_);
  trim_.transferState(from.trim_);
  line_.transferState(from.line_);
  last_stamp_ = from.last_stamp_;
}

}  // namespace polyfly
