#include "online_controller/estimation/vehicle_observer.hpp"

#include <algorithm>
#include <cmath>

#include "online_controller/types/attitude.hpp"

namespace polyfly {
namespace {

// Standard deviation of a measured rate, which mav_control_rw does not measure [rad/s].
constexpr double kRateNoise = 0.05;

/// angle' = rate, rate' = stiffness angle + damping rate + gain u + moment.
DisturbanceObserver makeLoop(double stiffness, double damping, double gain,
                             const MultirotorOptions& vehicle) {
  MpcProblem problem;
  problem.name = "moment observer";
  problem.A_c = (Eigen::Matrix2d() << 0.0, 1.0, stiffness, damping).finished();
  problem.B_c = Eigen::Vector2d(0.0, gain);
  problem.Bd_c = Eigen::Vector2d(0.0, 1.0);
  problem.C = Eigen::RowVector2d(1.0, 0.0);
  ObserverOptions options;
  const ObserverNoise& noise = vehicle.noise;
  options.period = vehicle.control_period;
  options.process = {std::sqrt(noise.q_attitude), std::sqrt(noise.q_angular_velocity), 0.0, 0.0};
  options.measurement = {std::sqrt(noise.r_attitude), kRateNoise, 1.0, 1.0};
  options.disturbance = std::sqrt(noise.q_torque);
  return {problem, options};
}

DisturbanceObserver makeTilt(double omega, double damping, double gain, const MultirotorOptions& vehicle) {
  return makeLoop(-omega * omega, -2.0 * damping * omega, gain * omega * omega, vehicle);
}

const MomentModel& checked(const MomentModel& moments) {
  checkMomentModel(moments);
  return moments;
}

}  // namespace

VehicleObserver::VehicleObserver(const MultirotorModel& model, const MultirotorOptions& vehicle,
                                 const MomentModel& moments)
    : mass_(vehicle.mass),
      duration_(checked(moments).calibration_duration),
      force_(model, vehicle),
      angles_{makeTilt(moments.roll_omega, moments.roll_damping, moments.roll_gain, vehicle),
              makeTilt(moments.pitch_omega, moments.pitch_damping, moments.pitch_gain, vehicle),
              makeLoop(0.0, -moments.yaw_omega, moments.yaw_gain * moments.yaw_omega, vehicle)},
      line_(vehicle.control_period) {}

void VehicleObserver::transferState(const VehicleObserver& other) noexcept {
  force_.transferState(other.force_);
  for (std::size_t i = 0; i < angles_.size(); ++i) angles_[i].transferState(other.angles_[i]);
  estimate_ = other.estimate_;
  line_.transferState(other.line_);
  calibration_ = other.calibration_;
}

void VehicleObserver::restart() noexcept { line_.restart(); }

void VehicleObserver::reset() noexcept {
  forget();
  line_.restart();
}

void VehicleObserver::forget() noexcept {
  force_.reset();
  for (DisturbanceObserver& angle : angles_) angle.reset();
  calibration_.runs = false;
}

void VehicleObserver::calibrate() noexcept {
  const unsigned finished = calibration_.finished;
  calibration_ = {};
  calibration_.runs = true;
  calibration_.finished = finished;
}

void VehicleObserver::update(const VehicleState& state, const AttitudeCommand& held) noexcept {
  const SampleLine::Step step = line_.next(state.stamp);
  if (step.is_other_flight) forget();
  const int periods = step.periods;
  if (periods == 0) return;
  force_.update(state, held.thrust / mass_, periods);
  updateMoments(state, held, periods);

  estimate_.position = force_.position();
  estimate_.velocity = force_.velocity();
  Eigen::Vector3d moment;
  for (std::size_t i = 0; i < angles_.size(); ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    estimate_.attitude(axis) = angles_[i].state()[0];
    estimate_.angular_velocity(axis) = angles_[i].state()[1];
    moment(axis) = angles_[i].disturbance();
  }
  if (calibration_.runs) advanceCalibration(state.stamp, force_.disturbance(), moment);
  estimate_.force = force_.disturbance() - estimate_.force_offset;
  estimate_.moment = moment - estimate_.moment_offset;
}

void VehicleObserver::updateMoments(const VehicleState& state, const AttitudeCommand& held,
                                    int periods) noexcept {
  const EulerAngles angles = eulerAngles(state.attitude.normalized());
  const EulerAngles rates = eulerRates(angles, state.angular_velocity);
  // Yaw is unwrapped by what is known of it: the filter must not see a turn as a jump.
  const double yaw = estimate_.attitude.z() + wrapAngle(angles.yaw - estimate_.attitude.z());
  const std::array<double, 3> measured{angles.roll, angles.pitch, yaw};
  const std::array<double, 3> measured_rates{rates.roll, rates.pitch, rates.yaw};
  const std::array<double, 3> commands{held.roll, held.pitch, held.yaw_rate};
  for (std::size_t i = 0; i < angles_.size(); ++i) {
    const std::array<double, 2> sample{measured[i], measured_rates[i]};
    angles_[i].update(sample.data(), &commands[i], periods);
  }
}

void VehicleObserver::advanceCalibration(double stamp, const Eigen::Vector3d& force,
                                         const Eigen::Vector3d& moment) noexcept {
  if (calibration_.samples == 0) calibration_.start = stamp;
  calibration_.force_sum += force;
  calibration_.moment_sum += moment;
  ++calibration_.samples;
  if (stamp - calibration_.start < duration_) return;
  estimate_.force_offset = calibration_.force_sum / calibration_.samples;
  estimate_.moment_offset = calibration_.moment_sum / calibration_.samples;
  calibration_.runs = false;
  ++calibration_.finished;
}

}  // namespace polyfly
