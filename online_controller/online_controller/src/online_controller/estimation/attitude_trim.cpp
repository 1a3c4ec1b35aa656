#include "online_controller/estimation/attitude_trim.hpp"

#include <algorithm>
#include <cmath>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Standard deviations of the angle: of the model's error in one period, of the measurement [rad].
constexpr double kModelError = 0.01;
constexpr double kNoise = 0.01;

constexpr int kMostPeriods = 1000000;

// First and greatest variance of the coupling: 0 may be the wrong end of 0 .. 1. Its drift per control period.
constexpr double kCouplingVariance = 1.0;
constexpr double kCouplingDrift = 0.005;
// Standard deviation of the noise of an angle's change in a period [rad].
constexpr double kCouplingNoise = 0.003;

// Standard deviations of c1 and c2, as shares of 1 / gain and time / gain.
constexpr double kGainDeviation = 0.15;
constexpr double kLagDeviation = 0.3;
// What a lag of first order leaves of a loop shows in seconds only: a dead time makes it swing slowly.
constexpr double kFirstNoise = 3.5;

}  // namespace

// angle' = (gain (u - trim) - angle) / time, with the trim as the disturbance.
AttitudeTrim::Loop AttitudeTrim::makeLoop(double gain, double time, const MultirotorOptions& options) {
  MpcProblem problem;
  problem.name = "attitude trim";
  problem.A_c = Eigen::MatrixXd::Constant(1, 1, -1.0 / time);
  problem.B_c = Eigen::MatrixXd::Constant(1, 1, gain / time);
  problem.Bd_c = -problem.B_c;
  problem.C = Eigen::MatrixXd::Identity(1, 1);
  ObserverOptions observer;
  observer.period = options.control_period;
  observer.process[0] = kModelError;
  observer.measurement[0] = kNoise;
  observer.disturbance = options.trim_drift;
  Loop loop{{problem, observer}, gain, time, {}, {}};
  if (options.adapt_model) {
    loop.by_angle.emplace(problem, observer, 0, kGainDeviation / gain, kFirstNoise);
    loop.by_rate.emplace(problem, observer, 0, kLagDeviation * time / gain, kFirstNoise);
  }
  return loop;
}

FlownReference flown(const FollowedReference& followed, const TiltAngles& tilt,
                     const Eigen::Vector3d& velocity) noexcept {
  constexpr double kTilt = 0.1;      // [rad]
  constexpr double kVelocity = 0.5;  // [m/s]
  const TiltAngles& whole = followed.whole_tilt;
  const bool is_near = std::hypot(tilt.roll - whole.roll, tilt.pitch - whole.pitch) < kTilt &&
                       (velocity - followed.velocity).norm() < kVelocity;
  return is_near ? FlownReference{followed.tilt, followed.velocity} : FlownReference{};
}

AttitudeTrim::AttitudeTrim(const TiltModel& model, const MultirotorOptions& options)
    : model_(model),
      given_{options.roll_trim, options.pitch_trim},
      period_(options.control_period),
      variance_(kCouplingVariance) {
  for (const double number : {model.roll_gain, model.roll_time, model.pitch_gain, model.pitch_time}) {
    if (!(number > 0.0)) throw Error("attitude trim: gain and time must be above 0");
  }
  if (options.trim_drift == 0.0 || !options.offset_free) return;
  loops_ = {makeLoop(model.roll_gain, model.roll_time, options),
            makeLoop(model.pitch_gain, model.pitch_time, options)};
}

// c1 s + c2 s' is the part of the disturbance with which the model's angle ends where the loop's does that was found:
// after these periods the latter is what its own lag makes of it. `turned` is the command that the coupling stands for in
// the model.
void AttitudeTrim::updateLoop(Loop& loop, double measured, double command, double turned,
                              int periods) const noexcept {
  const double whole = command + turned;
  double known = 0.0;
  if (loop.by_angle) {
    const double duration = period_ * periods;
    const double stiffness = loop.stiffness(), damping = loop.damping();
    const double angle = loop.observer.state()[0];
    const double trim = loop.observer.disturbance();
    const double drive = command - trim + damping * loop.gain / loop.time * turned;
    const double moved = -std::expm1(-duration * stiffness / damping) * (drive / stiffness - angle);
    const double share = -std::expm1(-duration / loop.time);
    known = whole - trim - (moved / share + angle) / loop.gain;
  }
  loop.observer.update(&measured, &whole, periods, known);
}

void AttitudeTrim::update(const TiltAngles& measured, const AttitudeCommand& held, int periods,
                          const std::optional<FollowedTilt>& followed) noexcept {
  if (measured_ && periods == 1) learnCoupling(measured, held);
  if (loops_) {
    const TiltAngles turned = turn(last_, held.yaw_rate);
    const FollowedTilt wanted = inLoops(followed.value_or(FollowedTilt{}), held.yaw_rate);
    const std::array<double, 2> measured_angles{measured.roll, measured.pitch};
    const std::array<double, 2> commands{held.roll - given_.roll, held.pitch - given_.pitch};
    const std::array<double, 2> turns{coupling_ * turned.roll, coupling_ * turned.pitch};
    const std::array<double, 2> angles{wanted.angle.roll, wanted.angle.pitch};
    const std::array<double, 2> rates{wanted.rate.roll, wanted.rate.pitch};
    bool within = true;
    for (std::size_t i = 0; i < angles.size(); ++i) {
      Loop& loop = (*loops_)[i];
      updateLoop(loop, measured_angles[i], commands[i], turns[i], periods);
      if (loop.by_angle) {
        const auto signal = [&](double value) { return followed ? std::optional(-value) : std::nullopt; };
        loop.by_angle->update(loop.observer, signal(angles[i]), periods);
        loop.by_rate->update(loop.observer, signal(rates[i]), periods);
      }
      within = within && std::abs(loop.observer.disturbance()) < kMost;
      loop.observer.setDisturbance(std::clamp(loop.observer.disturbance(), -kMost, kMost));
    }
    within_ = within ? std::min(within_ + 1, kMostPeriods) : 0;
  }
  last_ = measured;
  measured_ = true;
}

// The rates that the loops themselves have to give: those of a coupling come by themselves.
FollowedTilt AttitudeTrim::inLoops(const FollowedTilt& followed, double yaw_rate) const noexcept {
  const double turned = coupling_ * yaw_rate;
  return {followed.angle,
          {followed.rate.roll - turned * followed.angle.pitch,
           followed.rate.pitch + turned * followed.angle.roll}};
}

TiltAngles AttitudeTrim::feedForward(const FollowedTilt& followed, double yaw_rate) const noexcept {
  if (!loops_ || !(*loops_)[0].by_angle) return {};
  const FollowedTilt wanted = inLoops(followed, yaw_rate);
  const Loop &roll = (*loops_)[0], &pitch = (*loops_)[1];
  return {roll.by_angle->value() * wanted.angle.roll + roll.by_rate->value() * wanted.rate.roll,
          pitch.by_angle->value() * wanted.angle.pitch + pitch.by_rate->value() * wanted.rate.pitch};
}

TiltAngles AttitudeTrim::turn(const TiltAngles& tilt, double yaw_rate) const noexcept {
  return {model_.roll_time / model_.roll_gain * yaw_rate * tilt.pitch,
          -model_.pitch_time / model_.pitch_gain * yaw_rate * tilt.roll};
}

TiltModel AttitudeTrim::loops() const noexcept {
  if (!loops_) return model_;
  const Loop &roll = (*loops_)[0], &pitch = (*loops_)[1];
  return {1.0 / roll.stiffness(), roll.damping() / roll.stiffness(), 1.0 / pitch.stiffness(),
          pitch.damping() / pitch.stiffness()};
}

// What the model without a coupling leaves of the change in a period is slope c, and noise.
void AttitudeTrim::learnCoupling(const TiltAngles& measured, const AttitudeCommand& held) noexcept {
  const TiltAngles trim = angles();
  const TiltModel model = loops();
  const double roll_share = -std::expm1(-period_ / model.roll_time);
  const double pitch_share = -std::expm1(-period_ / model.pitch_time);
  const std::array<double, 2> slopes{roll_share * model.roll_time * held.yaw_rate * last_.pitch,
                                     -pitch_share * model.pitch_time * held.yaw_rate * last_.roll};
  const std::array<double, 2> left{
      measured.roll - last_.roll - roll_share * (model.roll_gain * (held.roll - trim.roll) - last_.roll),
      measured.pitch - last_.pitch -
          pitch_share * (model.pitch_gain * (held.pitch - trim.pitch) - last_.pitch)};
  variance_ = std::min(variance_ + kCouplingDrift * kCouplingDrift, kCouplingVariance);
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const double gain =
        variance_ * slopes[i] / (slopes[i] * slopes[i] * variance_ + kCouplingNoise * kCouplingNoise);
    coupling_ += gain * (left[i] - slopes[i] * coupling_);
    variance_ -= gain * slopes[i] * variance_;
  }
  coupling_ = std::clamp(coupling_, 0.0, 1.0);
}

TiltAngles AttitudeTrim::added(const TiltAngles& tilt, double yaw_rate, double wanted) const noexcept {
  const TiltAngles trim = angles();
  const TiltAngles turned = turn(tilt, yaw_rate);
  return {trim.roll + (wanted - coupling_) * turned.roll, trim.pitch + (wanted - coupling_) * turned.pitch};
}

void AttitudeTrim::reset() noexcept {
  coupling_ = 0.0;
  variance_ = kCouplingVariance;
  measured_ = false;
  within_ = 0;
  if (!loops_) return;
  for (Loop& loop : *loops_) loop.observer.reset();
  forgetLoops();
}

void AttitudeTrim::forgetLoops() noexcept {
  if (!loops_) return;
  for (Loop& loop : *loops_) {
    if (!loop.by_angle) continue;
    loop.by_angle->reset();
    loop.by_rate->reset();
  }
}

void AttitudeTrim::transferState(const AttitudeTrim& other) noexcept {
  last_ = other.last_;
  measured_ = other.measured_;
  coupling_ = other.coupling_;
  variance_ = other.variance_;
  if (!loops_ || !other.loops_) return;
  within_ = other.within_;
  for (std::size_t i = 0; i < loops_->size(); ++i) {
    Loop& loop = (*loops_)[i];
    const Loop& from = (*other.loops_)[i];
    loop.observer.transferState(from.observer);
    if (!loop.by_angle || !from.by_angle) continue;
    loop.by_angle->transferState(*from.by_angle, 1.0 / from.gain - 1.0 / loop.gain);
    loop.by_rate->transferState(*from.by_rate, from.time / from.gain - loop.time / loop.gain);
  }
}

TiltAngles AttitudeTrim::level() const noexcept { return within_ * period_ >= kSettled ? angles() : given_; }

TiltAngles AttitudeTrim::angles() const noexcept {
  if (!loops_) return given_;
  return {given_.roll + (*loops_)[0].observer.disturbance(),
          given_.pitch + (*loops_)[1].observer.disturbance()};
}

}  // namespace polyfly
