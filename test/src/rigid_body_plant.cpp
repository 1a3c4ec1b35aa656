#include "polyfly_test/rigid_body_plant.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

// Places of the rotors, in units of the arm, and the signs of their yawing moments.
const Eigen::Array4d kForward(1.0, -1.0, -1.0, 1.0);
const Eigen::Array4d kLeft(1.0, 1.0, -1.0, -1.0);
const Eigen::Array4d kSpin(1.0, -1.0, 1.0, -1.0);

Eigen::Quaterniond rotatedBy(const Eigen::Quaterniond& attitude, const Eigen::Vector3d& turn) {
  const double angle = turn.norm();
  if (angle == 0.0) return attitude;
  return (attitude * Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle))).normalized();
}

}  // namespace

RigidBodyPlant::RigidBodyPlant(const RigidBodyOptions& options, const Eigen::Vector3d& position)
    : options_(options),
      motion_{position, Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(),
              Rotors::Constant(std::sqrt(options.mass * options.gravity / 4.0))},
      noise_(static_cast<std::uint64_t>(options.seed)) {
  acting_.thrust = options.mass * options.gravity;
}

// A proportional and derivative controller of roll and pitch at the yaw of now, and one of the yaw rate.
RigidBodyPlant::Rotors RigidBodyPlant::demandedThrusts(const Motion& at) const {
  const Eigen::Matrix3d R = at.attitude.toRotationMatrix();
  const Eigen::Quaterniond goal =
      Eigen::Quaterniond(Eigen::AngleAxisd(std::atan2(R(1, 0), R(0, 0)), Eigen::Vector3d::UnitZ())) *
      Eigen::AngleAxisd(acting_.pitch, Eigen::Vector3d::UnitY()) *
      Eigen::AngleAxisd(acting_.roll, Eigen::Vector3d::UnitX());
  const Eigen::Quaterniond error = at.attitude.conjugate() * goal;
  const Eigen::Vector3d turn = (error.w() < 0.0 ? -2.0 : 2.0) * error.vec();
  const Eigen::Vector3d angular(options_.stiffness * turn.x() - options_.damping * at.rates.x(),
                                options_.stiffness * turn.y() - options_.damping * at.rates.y(),
                                options_.yaw_damping * (acting_.yaw_rate - at.rates.z()));
  const Eigen::Vector3d moment =
      options_.inertia.cwiseProduct(angular).cwiseMax(-options_.moment_max).cwiseMin(options_.moment_max);
  const Rotors thrusts =
      0.25 * (acting_.thrust + moment.x() / options_.arm * kLeft - moment.y() / options_.arm * kForward +
              moment.z() / options_.moment_ratio * kSpin);
  return thrusts.max(0.0).min(options_.rotor_max);
}

RigidBodyPlant::Slope RigidBodyPlant::slope(const Motion& at) const {
  const Eigen::Matrix3d R = at.attitude.toRotationMatrix();
  const Rotors thrusts = at.speed.square();
  const Eigen::Vector3d through = R.transpose() * at.velocity;
  const Eigen::Vector3d along(-options_.drag * through.x(), -options_.drag * through.y(),
                              thrusts.sum() / options_.mass);
  const Eigen::Vector3d moment(options_.arm * (kLeft * thrusts).sum(),
                               -options_.arm * (kForward * thrusts).sum(),
                               options_.moment_ratio * (kSpin * thrusts).sum());
  const Eigen::Vector3d momentum = options_.inertia.cwiseProduct(at.rates);
  const Rotors missing = demandedThrusts(at).sqrt() - at.speed;
  Slope result;
  result.acceleration = R * along + options_.force / options_.mass;
  result.acceleration.z() -= options_.gravity;
  result.angular = (moment - at.rates.cross(momentum)).cwiseQuotient(options_.inertia);
  result.speed = (missing > 0.0).select(missing / options_.rotor_up, missing / options_.rotor_down);
  return result;
}

RigidBodyPlant::Motion RigidBodyPlant::moved(const Motion& from, const Motion& at, const Slope& slope,
                                             double h) {
  return {from.position + h * at.velocity, from.velocity + h * slope.acceleration,
          rotatedBy(from.attitude, h * at.rates), from.rates + h * slope.angular,
          from.speed + h * slope.speed};
}

void RigidBodyPlant::advance(const AttitudeCommand& command, double period) {
  pending_.push_back({step_ + std::lround(options_.command_delay / kStep), command});
  const long steps = std::lround(period / kStep);
  for (long i = 0; i < steps; ++i, ++step_) {
    while (!pending_.empty() && pending_.front().step <= step_) {
      acting_ = pending_.front().command;
      pending_.pop_front();
    }
    const Motion middle = moved(motion_, motion_, slope(motion_), 0.5 * kStep);
    motion_ = moved(motion_, middle, slope(middle), kStep);
  }
}

VehicleState RigidBodyPlant::truth() const {
  return {time(), motion_.position, motion_.velocity, motion_.attitude, motion_.rates};
}

VehicleState RigidBodyPlant::measure() {
  VehicleState state = truth();
  state.position += options_.position_noise * noise_.next3();
  state.velocity += options_.velocity_noise * noise_.next3();
  state.attitude = rotatedBy(state.attitude, options_.attitude_noise * noise_.next3());
  return state;
}

double RigidBodyPlant::thrust() const noexcept { return motion_.speed.square().sum(); }

double RigidBodyPlant::energy() const noexcept {
  return 0.5 * options_.mass * motion_.velocity.squaredNorm() +
         0.5 * motion_.rates.dot(options_.inertia.cwiseProduct(motion_.rates)) +
         options_.mass * options_.gravity * motion_.position.z();
}

}  // namespace polyfly
