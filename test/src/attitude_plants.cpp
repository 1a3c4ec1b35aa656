#include "polyfly_test/attitude_plants.hpp"

#include <cmath>

namespace polyfly {
namespace {

constexpr double kStep = 0.00025;  // [s]
// Time constant of PX4's rate loop before the motors [s].
constexpr double kRateTime = 0.04;
// Stiffness of Lee's controller over inertia, about roll and pitch [1/s^2].
constexpr double kStiffness = 57.6;
// A fit of first order to motions of some 1.4 rad/s takes what that stiffness adds to the response for gain.
constexpr double kGeometricGain = 0.966;
// Stiffness about yaw [1/s^2]. The yaw is not held: only its rate is commanded.
constexpr double kYawStiffness = 1e-3;

Eigen::Quaterniond aboutZ(double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
}

double yawOf(const Eigen::Quaterniond& attitude) {
  const Eigen::Vector3d forward = attitude * Eigen::Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

/// Attitude of a tilt at the vehicle's own yaw.
Eigen::Quaterniond wanted(const Eigen::Quaterniond& attitude, double roll, double pitch) {
  return aboutZ(yawOf(attitude)) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
}

/// Vector of the rotation by half a skew matrix.
Eigen::Vector3d vee(const Eigen::Matrix3d& skew) { return {skew(2, 1), skew(0, 2), skew(1, 0)}; }

Eigen::Quaterniond turned(const Eigen::Quaterniond& attitude, const Eigen::Vector3d& by) {
  const double angle = by.norm();
  if (angle == 0.0) return attitude;
  return (attitude * Eigen::Quaterniond(Eigen::AngleAxisd(angle, by / angle))).normalized();
}

}  // namespace

AttitudePlant::AttitudePlant(const AttitudePlantOptions& options, const Eigen::Vector3d& position, double yaw)
    : options_(options),
      motion_{position,
              Eigen::Vector3d::Zero(),
              aboutZ(yaw),
              Eigen::Vector3d::Zero(),
              Eigen::Vector3d::Zero(),
              options.gravity},
      noise_(static_cast<std::uint64_t>(options.seed)) {}

// Of a vehicle whose rates are commanded.
Eigen::Vector3d AttitudePlant::demandedRates(const Motion& at, const AttitudeCommand& command) const {
  const double roll = options_.gain * command.roll, pitch = options_.gain * command.pitch;
  if (options_.loop == AttitudeLoop::kBodyRates) {
    const Eigen::Matrix3d R = at.attitude.toRotationMatrix();
    return {(roll - std::atan2(R(2, 1), R(2, 2))) / options_.roll_time,
            (pitch + std::asin(R(2, 0))) / options_.pitch_time, command.yaw_rate};
  }
  const Eigen::Quaterniond error = at.attitude.conjugate() * wanted(at.attitude, roll, pitch);
  const Eigen::Vector3d turn = (error.w() < 0.0 ? -2.0 : 2.0) * error.vec();
  return Eigen::Vector3d(turn.x() / options_.roll_time, turn.y() / options_.pitch_time, 0.0) +
         command.yaw_rate * (at.attitude.conjugate() * Eigen::Vector3d::UnitZ());
}

Eigen::Vector3d AttitudePlant::demandedMoment(const Motion& at, const AttitudeCommand& command) const {
  if (options_.loop != AttitudeLoop::kGeometric) {
    const Eigen::Vector3d lag(kRateTime, kRateTime, options_.yaw_time);
    return (demandedRates(at, command) - at.rates).cwiseQuotient(lag);
  }
  const Eigen::Matrix3d R = at.attitude.toRotationMatrix();
  const double gain = kGeometricGain * options_.gain;
  const Eigen::Matrix3d goal =
      wanted(at.attitude, gain * command.roll, gain * command.pitch).toRotationMatrix();
  const Eigen::Vector3d turn = 0.5 * vee(goal.transpose() * R - R.transpose() * goal);
  const Eigen::Vector3d rates = at.rates - R.transpose() * goal * Eigen::Vector3d(0.0, 0.0, command.yaw_rate);
  // Slow motions see damping over stiffness as the time constant.
  const Eigen::Vector3d stiffness(kStiffness, kStiffness, kYawStiffness);
  const Eigen::Vector3d damping(kStiffness * options_.roll_time, kStiffness * options_.pitch_time,
                                1.0 / options_.yaw_time);
  return -stiffness.cwiseProduct(turn) - damping.cwiseProduct(rates);
}

AttitudePlant::Slope AttitudePlant::slope(const Motion& at, const AttitudeCommand& command) const {
  const Eigen::Matrix3d R = at.attitude.toRotationMatrix();
  const Eigen::Vector3d through = R.transpose() * at.velocity;
  Slope result;
  result.acceleration =
      R * Eigen::Vector3d(-options_.drag * through.x(), -options_.drag * through.y(), at.thrust) +
      options_.force / options_.mass - Eigen::Vector3d(0.0, 0.0, options_.gravity);
  result.angular = at.moment;
  result.moment = (demandedMoment(at, command) - at.moment) / options_.motor_time;
  result.thrust = (command.thrust / options_.mass - at.thrust) / options_.motor_time;
  return result;
}

AttitudePlant::Motion AttitudePlant::moved(const Motion& from, const Motion& at, const Slope& slope,
                                           double h) {
  return {from.position + h * at.velocity,     from.velocity + h * slope.acceleration,
          turned(from.attitude, h * at.rates), from.rates + h * slope.angular,
          from.moment + h * slope.moment,      from.thrust + h * slope.thrust};
}

void AttitudePlant::advance(const AttitudeCommand& command, double period) {
  const long steps = std::lround(period / kStep);
  const double h = period / static_cast<double>(steps);
  for (long i = 0; i < steps; ++i) {
    const bool at_once = options_.loop == AttitudeLoop::kBodyRates;
    if (at_once) motion_.rates.head<2>() = demandedRates(motion_, command).head<2>();
    Motion middle = moved(motion_, motion_, slope(motion_, command), 0.5 * h);
    if (at_once) middle.rates.head<2>() = demandedRates(middle, command).head<2>();
    motion_ = moved(motion_, middle, slope(middle, command), h);
  }
  time_ += period;
}

VehicleState AttitudePlant::measure() {
  VehicleState state;
  state.stamp = time_;
  state.position = motion_.position + options_.position_noise * noise_.next3();
  state.velocity = motion_.velocity + options_.velocity_noise * noise_.next3();
  state.attitude = turned(motion_.attitude, options_.attitude_noise * noise_.next3());
  state.angular_velocity = motion_.rates;
  return state;
}

}  // namespace polyfly
