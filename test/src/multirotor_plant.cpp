#include "polyfly_test/multirotor_plant.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "polyfly_base/error.hpp"
#include "polyfly_test/range_check.hpp"

namespace polyfly {
namespace {

constexpr double kWholeSteps = 1e-6;  // how far a ratio of times may be from a whole number
constexpr std::uint64_t kSensorStream = 0x9e3779b97f4a7c15u;  // keeps gusts and sensor noise apart
constexpr std::uint64_t kTurbulenceStream = 0xd1b54a32d192ed03u;

// What is integrated: position, velocity, roll, pitch, yaw, yaw rate, thrust; the load's offset and velocity.
using StateVector = Eigen::Matrix<double, 17, 1>;

// What acts besides the command, constant over a substep.
struct Surroundings {
  Eigen::Vector3d push;          // [m/s^2]
  Eigen::Vector3d air_velocity;  // [m/s]
  Eigen::Vector3d hit;           // on the load [N]
  bool tumbling = false;
};

StateVector pack(const PlantState& state) {
  StateVector x;
  x << state.position, state.velocity, state.roll, state.pitch, state.yaw, state.yaw_rate, state.thrust,
      state.load_offset, state.load_velocity;
  return x;
}

PlantState unpack(const StateVector& x) {
  PlantState state;
  state.position = x.segment<3>(0);
  state.velocity = x.segment<3>(3);
  state.roll = x[6];
  state.pitch = x[7];
  state.yaw = x[8];
  state.yaw_rate = x[9];
  state.thrust = x[10];
  state.load_offset = x.segment<3>(11);
  state.load_velocity = x.segment<3>(14);
  return state;
}

double lagRate(double target, double value, double time) {
  return time > 0.0 ? (target - value) / time : 0.0;
}

double rollRate(const PlantOptions& options, const AttitudeCommand& command, double roll) {
  return (options.roll_gain * command.roll + options.roll_offset - roll) / options.roll_time;
}

double pitchRate(const PlantOptions& options, const AttitudeCommand& command, double pitch) {
  return (options.pitch_gain * command.pitch + options.pitch_offset - pitch) / options.pitch_time;
}

// Eq. 37, with the yaw rate and the thrust as further first-order lags, and a load on a string.
StateVector derivative(const PlantOptions& options, const StateVector& x, const AttitudeCommand& command,
                       const Surroundings& around) {
  StateVector rate = StateVector::Zero();
  const Eigen::Vector3d velocity = x.segment<3>(3);
  rate.segment<3>(0) = velocity;
  rate.segment<3>(3) = bodyZ(x[6], x[7], x[8]) * x[10] -
                       options.drag.cwiseProduct(velocity - around.air_velocity) + around.push;
  if (options.load.mass > 0.0) {
    const Eigen::Vector3d load_velocity = x.segment<3>(14);
    const Eigen::Vector3d pull = options.load.pull(x.segment<3>(11), load_velocity - velocity);
    rate.segment<3>(3) += pull / options.mass;
    rate.segment<3>(11) = load_velocity - velocity;
    rate.segment<3>(14) =
        (around.hit - pull - options.load.drag * (load_velocity - around.air_velocity)) / options.load.mass;
    rate[16] -= options.gravity;
  }
  rate[5] -= options.gravity;
  rate[6] = rollRate(options, command, x[6]);
  rate[7] = pitchRate(options, command, x[7]);
  rate[8] = x[9];
  if (around.tumbling) rate.segment<3>(6) = options.tumble;
  rate[9] = lagRate(command.yaw_rate, x[9], options.yaw_rate_time);
  rate[10] = lagRate(command.thrust / options.mass, x[10], options.thrust_time);
  return rate;
}

// Rates of the Euler angles as angular velocity in the body.
Eigen::Vector3d bodyRates(const PlantState& state, double roll_rate, double pitch_rate) {
  const double sin_roll = std::sin(state.roll);
  const double cos_roll = std::cos(state.roll);
  const double cos_pitch = std::cos(state.pitch);
  return {roll_rate - std::sin(state.pitch) * state.yaw_rate,
          cos_roll * pitch_rate + sin_roll * cos_pitch * state.yaw_rate,
          -sin_roll * pitch_rate + cos_roll * cos_pitch * state.yaw_rate};
}

// `tilt_rates`: of roll and pitch [rad/s].
VehicleState toVehicleState(const PlantState& state, const Eigen::Vector2d& tilt_rates, double stamp) {
  VehicleState vehicle;
  vehicle.stamp = stamp;
  vehicle.position = state.position;
  vehicle.velocity = state.velocity;
  vehicle.attitude = Eigen::AngleAxisd(state.yaw, Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(state.pitch, Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(state.roll, Eigen::Vector3d::UnitX());
  vehicle.angular_velocity = bodyRates(state, tilt_rates.x(), tilt_rates.y());
  return vehicle;
}

// Number of `part`s in `whole`, which must be a whole number.
std::int64_t wholeSteps(double whole, double part, const char* name) {
  const double ratio = whole / part;
  const double steps = std::round(ratio);
  if (std::abs(ratio - steps) > kWholeSteps * std::max(1.0, steps)) {
    throw Error("vehicle: " + std::string(name) + ": must be a multiple of substep " + std::to_string(part) +
                " s, got " + std::to_string(whole) + " s");
  }
  return static_cast<std::int64_t>(steps);
}

}  // namespace

void checkPlantOptions(const PlantOptions& options) {
  visitPlantOptions(options, VectorRangeCheck{{"vehicle"}});
  if (options.thrust_min > options.thrust_max) {
    throw Error("vehicle: thrust_min: must not exceed thrust_max");
  }
  if (options.turbulence_sigma.norm() > 0.0 && !(options.air_velocity.norm() > 0.0)) {
    throw Error("vehicle: turbulence_sigma: needs an air_velocity that carries it");
  }
  if (wholeSteps(options.period, options.substep, "period") < 1) {
    throw Error("vehicle: substep: must not exceed period");
  }
  wholeSteps(options.command_delay, options.substep, "command_delay");
  wholeSteps(options.odometry_delay, options.substep, "odometry_delay");
}

Eigen::Vector3d bodyZ(double roll, double pitch, double yaw) {
  const double sin_roll = std::sin(roll);
  const double cos_roll = std::cos(roll);
  const double sin_pitch = std::sin(pitch);
  const double sin_yaw = std::sin(yaw);
  const double cos_yaw = std::cos(yaw);
  return {cos_yaw * sin_pitch * cos_roll + sin_yaw * sin_roll,
          sin_yaw * sin_pitch * cos_roll - cos_yaw * sin_roll, std::cos(pitch) * cos_roll};
}

MultirotorPlant::MultirotorPlant(const PlantOptions& options, const PlantState& start)
    : options_(options),
      gust_noise_(static_cast<std::uint64_t>(options.seed)),
      sensor_noise_(static_cast<std::uint64_t>(options.seed) ^ kSensorStream),
      state_(start) {
  checkPlantOptions(options);
  if (!pack(start).allFinite()) {
    throw Error("vehicle: start: must be finite");
  }
  steps_per_period_ = wholeSteps(options.period, options.substep, "period");
  command_delay_steps_ = wholeSteps(options.command_delay, options.substep, "command_delay");
  odometry_delay_steps_ = wholeSteps(options.odometry_delay, options.substep, "odometry_delay");
  // The attitude that the start holds, so that nothing moves before the first command.
  acting_.roll = (start.roll - options.roll_offset) / options.roll_gain;
  acting_.pitch = (start.pitch - options.pitch_offset) / options.pitch_gain;
  acting_.yaw_rate = start.yaw_rate;
  acting_.thrust = start.thrust * options.mass;
  gust_ = options_.gust_sigma.cwiseProduct(gust_noise_.next3());  // stationary from the beginning
  if (options_.air_velocity.norm() > 0.0 && options_.turbulence_sigma.norm() > 0.0) {
    turbulence_.emplace(options_.air_velocity, options_.turbulence_sigma, options_.turbulence_length,
                        options_.substep, static_cast<std::uint64_t>(options_.seed) ^ kTurbulenceStream);
  }
  hangLoad();
  history_.push_back(truth());
}

double MultirotorPlant::time() const { return static_cast<double>(step_) * options_.substep; }

void MultirotorPlant::hangLoad() {
  if (options_.load.mass <= 0.0 || state_.load_offset.norm() > 0.0) return;
  state_.load_offset = {0.0, 0.0, -options_.load.hangingLength(options_.gravity)};
  state_.load_velocity = state_.velocity;
}

// Whether something of that start and duration acts now; with half a substep of play, so that rounding of the
// time does not decide.
bool MultirotorPlant::during(double start, double duration) const {
  const double since = time() - start;
  const double play = 0.5 * options_.substep;
  return since > -play && since < duration - play;
}

bool MultirotorPlant::isTumbling() const { return during(options_.tumble_start, options_.tumble_time); }

Eigen::Vector3d MultirotorPlant::push() const {
  const bool kicked = during(options_.kick_start, options_.kick_time);
  return kicked ? Eigen::Vector3d(options_.wind + gust_ + options_.kick)
                : Eigen::Vector3d(options_.wind + gust_);
}

Eigen::Vector3d MultirotorPlant::airVelocity() const {
  return turbulence_ ? Eigen::Vector3d(options_.air_velocity + turbulence_->velocity())
                     : options_.air_velocity;
}

Eigen::Vector3d MultirotorPlant::hit() const {
  return during(options_.load_hit_start, options_.load_hit_time) ? options_.load_hit
                                                                 : Eigen::Vector3d::Zero();
}

Eigen::Vector3d MultirotorPlant::disturbance() const {
  Eigen::Vector3d all = push() + options_.drag.cwiseProduct(airVelocity());
  if (options_.load.mass > 0.0) {
    all += options_.load.pull(state_.load_offset, state_.load_velocity - state_.velocity) / options_.mass;
  }
  return all;
}

AttitudeCommand MultirotorPlant::saturate(const AttitudeCommand& command) {
  AttitudeCommand cut;
  cut.roll = std::clamp(command.roll, -options_.angle_max, options_.angle_max);
  cut.pitch = std::clamp(command.pitch, -options_.angle_max, options_.angle_max);
  cut.yaw_rate = std::clamp(command.yaw_rate, -options_.yaw_rate_max, options_.yaw_rate_max);
  cut.thrust =
      std::clamp(command.thrust, options_.thrust_min * options_.mass, options_.thrust_max * options_.mass);
  if (cut.roll != command.roll || cut.pitch != command.pitch || cut.yaw_rate != command.yaw_rate ||
      cut.thrust != command.thrust) {
    ++saturated_;
  }
  return cut;
}

void MultirotorPlant::advance(const AttitudeCommand& command) {
  const bool finite = std::isfinite(command.roll) && std::isfinite(command.pitch) &&
                      std::isfinite(command.yaw_rate) && std::isfinite(command.thrust);
  if (finite) {
    pending_.push_back({step_ + command_delay_steps_, saturate(command)});
  } else {
    ++ignored_;
  }
  for (std::int64_t i = 0; i < steps_per_period_; ++i) {
    while (!pending_.empty() && pending_.front().step <= step_) {
      acting_ = pending_.front().command;
      pending_.pop_front();
    }
    substep();
  }
}

// One step of the classical Runge-Kutta method; command and disturbance are constant over it.
void MultirotorPlant::substep() {
  // Without a lag the command acts at once.
  if (options_.yaw_rate_time <= 0.0) {
    state_.yaw_rate = acting_.yaw_rate;
  }
  if (options_.thrust_time <= 0.0) {
    state_.thrust = acting_.thrust / options_.mass;
  }
  const bool tumbling = isTumbling();
  if (tumbling) {
    state_.thrust = 0.0;
    state_.yaw_rate = options_.tumble.z();
  }
  const double h = options_.substep;
  const Surroundings around{push(), airVelocity(), hit(), tumbling};
  const StateVector x = pack(state_);
  const StateVector k1 = derivative(options_, x, acting_, around);
  const StateVector k2 = derivative(options_, x + 0.5 * h * k1, acting_, around);
  const StateVector k3 = derivative(options_, x + 0.5 * h * k2, acting_, around);
  const StateVector k4 = derivative(options_, x + h * k3, acting_, around);
  state_ = unpack(x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4));
  ++step_;
  drawGust();
  if (turbulence_) turbulence_->advance();
  history_.push_back(truth());
  while (static_cast<std::int64_t>(history_.size()) > odometry_delay_steps_ + 1) {
    history_.pop_front();
  }
}

// Exact discretisation of the first-order Gauss-Markov process: its variance does not depend on the step.
void MultirotorPlant::drawGust() {
  const double decay = std::exp(-options_.substep / options_.gust_time);
  const double drive = std::sqrt(1.0 - decay * decay);
  gust_ = decay * gust_ + drive * options_.gust_sigma.cwiseProduct(gust_noise_.next3());
}

VehicleState MultirotorPlant::truth() const {
  const Eigen::Vector2d tilt_rates = isTumbling()
                                         ? Eigen::Vector2d(options_.tumble.head<2>())
                                         : Eigen::Vector2d(rollRate(options_, acting_, state_.roll),
                                                           pitchRate(options_, acting_, state_.pitch));
  return toVehicleState(state_, tilt_rates, time());
}

VehicleState MultirotorPlant::measure() {
  VehicleState measured = history_.front();
  // Before the start the vehicle stood where it starts, so the stamp is older than the start at first.
  measured.stamp = static_cast<double>(step_ - odometry_delay_steps_) * options_.substep;
  measured.position += options_.position_noise * sensor_noise_.next3();
  measured.velocity += options_.velocity_noise * sensor_noise_.next3();
  const Eigen::Vector3d tilt = options_.attitude_noise * sensor_noise_.next3();
  const double angle = tilt.norm();
  if (angle > 0.0) {
    measured.attitude = measured.attitude * Eigen::Quaterniond(Eigen::AngleAxisd(angle, tilt / angle));
    measured.attitude.normalize();
  }
  measured.angular_velocity += options_.angular_velocity_noise * sensor_noise_.next3();
  return measured;
}

}  // namespace polyfly
