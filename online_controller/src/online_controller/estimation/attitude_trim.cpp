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

// First and greatest variance of the coupling: the given one may be at the wrong end of 0 .. 1.
constexpr double kCouplingVariance = 1.0;
// Standard deviation of the noise of an angle's change in a period [rad].
constexpr double kCouplingNoise = 0.003;

/// angle' = (gain (u - trim) - angle) / time, with the trim as the disturbance.
DisturbanceObserver makeLoop(double gain, double time, const MultirotorOptions& options) {
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
  return {problem, observer};
}

}  // namespace

AttitudeTrim::AttitudeTrim(const TiltModel& model, const MultirotorOptions& options)
    : model_(model),
      given_{options.roll_trim, options.pitch_trim},
      period_(options.control_period),
      given_coupling_(options.attitude_coupling),
      coupling_drift_(options.coupling_drift),
      decay_{std::exp(-options.control_period / model.roll_time),
             std::exp(-options.control_period / model.pitch_time)},
      coupling_(given_coupling_),
      variance_(kCouplingVariance) {
  for (const double number : {model.roll_gain, model.roll_time, model.pitch_gain, model.pitch_time}) {
    if (!(number > 0.0)) throw Error("attitude trim: gain and time must be above 0");
  }
  if (options.trim_drift == 0.0 || !options.offset_free) return;
  loops_ = {makeLoop(model.roll_gain, model.roll_time, options),
            makeLoop(model.pitch_gain, model.pitch_time, options)};
}

void AttitudeTrim::update(const TiltAngles& measured, const AttitudeCommand& held, int periods) noexcept {
  if (coupling_drift_ > 0.0 && measured_ && periods == 1) learnCoupling(measured, held);
  if (loops_) {
    const TiltAngles turned = turn(last_, held.yaw_rate);
    const std::array<double, 2> angles{measured.roll, measured.pitch};
    const std::array<double, 2> commands{held.roll - given_.roll + coupling_ * turned.roll,
                                         held.pitch - given_.pitch + coupling_ * turned.pitch};
    bool within = true;
    for (std::size_t i = 0; i < angles.size(); ++i) {
      DisturbanceObserver& loop = (*loops_)[i];
      loop.update(&angles[i], &commands[i], periods);
      within = within && std::abs(loop.disturbance()) < kMost;
      loop.setDisturbance(std::clamp(loop.disturbance(), -kMost, kMost));
    }
    within_ = within ? std::min(within_ + 1, kMostPeriods) : 0;
  }
  last_ = measured;
  measured_ = true;
}

TiltAngles AttitudeTrim::turn(const TiltAngles& tilt, double yaw_rate) const noexcept {
  return {model_.roll_time / model_.roll_gain * yaw_rate * tilt.pitch,
          -model_.pitch_time / model_.pitch_gain * yaw_rate * tilt.roll};
}

// What the model without a coupling leaves of the change in a period is slope c, and noise.
void AttitudeTrim::learnCoupling(const TiltAngles& measured, const AttitudeCommand& held) noexcept {
  const TiltAngles trim = angles();
  const TiltAngles turned = turn(last_, held.yaw_rate);
  const double roll_drive = model_.roll_gain * (1.0 - decay_.roll);
  const double pitch_drive = model_.pitch_gain * (1.0 - decay_.pitch);
  const std::array<double, 2> slopes{roll_drive * turned.roll, pitch_drive * turned.pitch};
  const std::array<double, 2> left{
      measured.roll - decay_.roll * last_.roll - roll_drive * (held.roll - trim.roll),
      measured.pitch - decay_.pitch * last_.pitch - pitch_drive * (held.pitch - trim.pitch)};
  variance_ = std::min(variance_ + coupling_drift_ * coupling_drift_, kCouplingVariance);
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
  coupling_ = given_coupling_;
  variance_ = kCouplingVariance;
  measured_ = false;
  within_ = 0;
  if (!loops_) return;
  for (DisturbanceObserver& loop : *loops_) loop.reset();
}

void AttitudeTrim::transferState(const AttitudeTrim& other) noexcept {
  last_ = other.last_;
  measured_ = other.measured_;
  if (coupling_drift_ > 0.0 && other.coupling_drift_ > 0.0) {
    coupling_ = other.coupling_;
    variance_ = other.variance_;
  }
  if (!loops_ || !other.loops_) return;
  within_ = other.within_;
  for (std::size_t i = 0; i < loops_->size(); ++i) (*loops_)[i].transferState((*other.loops_)[i]);
}

TiltAngles AttitudeTrim::level() const noexcept { return within_ * period_ >= kSettled ? angles() : given_; }

TiltAngles AttitudeTrim::angles() const noexcept {
  if (!loops_) return given_;
  return {given_.roll + (*loops_)[0].disturbance(), given_.pitch + (*loops_)[1].disturbance()};
}

}  // namespace polyfly
