#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "online_controller/types/types.hpp"
#include "polyfly_test/gaussian_source.hpp"

namespace polyfly {

/// How an autopilot turns commanded roll, pitch and yaw rate into motion. Eq. 37 has loops of the Euler
/// angles; autopilots do not. What distinguishes them is what a yaw rate does to a tilted vehicle.
enum class AttitudeLoop {
  /// Errors of roll and pitch are rates about the body's axes: the tilt stays in W while it yaws.
  kBodyRates,
  kGeometric,  ///< moments from the error on SO(3) and the rates (Lee, 2010), as RotorS: likewise
  /// Rates from the quaternion's error, and the yaw rate about the world's z axis, as PX4: the tilt turns
  /// with the body.
  kQuaternion
};

/// A rigid body in the air with an attitude controller of its own. The loops' gain and time constant are what a fit
/// of first order finds for a Firefly. The loops themselves have motors, and two of them a second order.
struct AttitudePlantOptions {
  AttitudeLoop loop = AttitudeLoop::kBodyRates;
  double mass = 1.52;       ///< [kg]
  double gravity = 9.8066;  ///< [m/s^2]
  /// Gain of the roll and pitch loops [1].
  double gain = 0.9;
  /// Time constant of the roll loop [s].
  double roll_time = 0.25;
  /// Time constant of the pitch loop [s].
  double pitch_time = 0.255;
  /// Time constant of the yaw rate [s].
  double yaw_time = 0.1;
  /// Lag of moments and thrust behind their commands [s].
  double motor_time = 0.02;
  /// Drag of the rotors, in the body's plane [1/s].
  double drag = 0.01;
  /// External force in W [N].
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  /// Standard deviation of the position noise per axis [m].
  double position_noise = 0.0;
  /// Standard deviation of the velocity noise per axis [m/s].
  double velocity_noise = 0.0;
  /// Standard deviation of the attitude noise per axis [rad].
  double attitude_noise = 0.0;
  int seed = 1;
};

/// Integrates in steps of a quarter of a millisecond, rotation on SO(3), by the midpoint rule. Shares nothing
/// with MultirotorPlant.
class AttitudePlant {
 public:
  /// Hovers at `position` with `yaw`.
  AttitudePlant(const AttitudePlantOptions& options, const Eigen::Vector3d& position, double yaw);

  /// Flies `period` seconds with the command.
  void advance(const AttitudeCommand& command, double period);

  VehicleState measure();  ///< odometry now, with noise
  double time() const noexcept { return time_; }
  const Eigen::Vector3d& position() const noexcept { return motion_.position; }
  const Eigen::Quaterniond& attitude() const noexcept { return motion_.attitude; }

 private:
  struct Motion {
    Eigen::Vector3d position, velocity;
    Eigen::Quaterniond attitude;
    Eigen::Vector3d rates;   // about the body's axes [rad/s]
    Eigen::Vector3d moment;  // over inertia [rad/s^2]
    double thrust;           // over mass [m/s^2]
  };
  struct Slope {
    Eigen::Vector3d acceleration, angular, moment;
    double thrust;
  };

  Eigen::Vector3d demandedRates(const Motion& at, const AttitudeCommand& command) const;
  Eigen::Vector3d demandedMoment(const Motion& at, const AttitudeCommand& command) const;
  Slope slope(const Motion& at, const AttitudeCommand& command) const;
  static Motion moved(const Motion& from, const Motion& at, const Slope& slope, double h);

  AttitudePlantOptions options_;
  Motion motion_;
  double time_ = 0.0;  // [s]
  GaussianSource noise_;
};

}  // namespace polyfly
