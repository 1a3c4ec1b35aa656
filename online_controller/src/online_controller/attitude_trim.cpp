#include "online_controller/attitude_trim.hpp"

#include <algorithm>
#include <cmath>

#include "region_maps/error.hpp"

namespace polyfly {
namespace {

// Standard deviations of the angle: of the model's error in one period, of the measurement [rad].
constexpr double kModelError = 0.01;
constexpr double kNoise = 0.01;

/// angle' = (gain (u - trim) - angle) / time, with the trim as the disturbance.
DisturbanceObserver makeLoop(double gain, double time, const MultirotorOptions& options) {
  if (!(gain > 0.0 && time > 0.0)) throw Error("attitude trim: gain and time must be above 0");
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
    : given_{options.roll_trim, options.pitch_trim} {
  if (options.trim_drift == 0.0 || !options.offset_free) return;
  loops_ = {makeLoop(model.roll_gain, model.roll_time, options),
            makeLoop(model.pitch_gain, model.pitch_time, options)};
}

void AttitudeTrim::update(const TiltAngles& measured, const AttitudeCommand& held, int periods) noexcept {
  if (!loops_) return;
  const std::array<double, 2> angles{measured.roll, measured.pitch};
  const std::array<double, 2> commands{held.roll - given_.roll, held.pitch - given_.pitch};
  for (std::size_t i = 0; i < angles.size(); ++i) {
    DisturbanceObserver& loop = (*loops_)[i];
    loop.update(&angles[i], &commands[i], periods);
    loop.setDisturbance(std::clamp(loop.disturbance(), -kMost, kMost));
  }
}

void AttitudeTrim::reset() noexcept {
  if (!loops_) return;
  for (DisturbanceObserver& loop : *loops_) loop.reset();
}

void AttitudeTrim::takeOver(const AttitudeTrim& other) noexcept {
  if (!loops_ || !other.loops_) return;
  for (std::size_t i = 0; i < loops_->size(); ++i) (*loops_)[i].takeOver((*other.loops_)[i]);
}

TiltAngles AttitudeTrim::angles() const noexcept {
  if (!loops_) return given_;
  return {given_.roll + (*loops_)[0].disturbance(), given_.pitch + (*loops_)[1].disturbance()};
}

}  // namespace polyfly
