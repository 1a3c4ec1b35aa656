#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <deque>

#include "online_controller/types/types.hpp"
#include "polyfly_test/gaussian_source.hpp"

namespace polyfly {

/// A quadrotor as a rigid body, with rotors that lag and an attitude controller of its own. The controller's gain is 1:
/// it reaches the commanded angles, where the shipped problems expect 0.9 of them.
struct RigidBodyOptions {
  double mass = 1.52;       ///< [kg]
  double gravity = 9.8066;  ///< [m/s^2]
  /// Principal moments of inertia [kg m^2].
  Eigen::Vector3d inertia{0.0348, 0.0459, 0.0977};
  /// Distance of each rotor from the body's x and y axes [m].
  double arm = 0.15;
  /// Yawing moment of a rotor over its thrust [m].
  double moment_ratio = 0.016;
  /// Lag of a rotor's speed while it rises [s].
  double rotor_up = 0.012;
  /// Lag of a rotor's speed while it falls [s].
  double rotor_down = 0.025;
  /// Greatest thrust of one rotor [N].
  double rotor_max = 8.0;
  /// Drag of the rotors over mass, in the body's plane [1/s].
  double drag = 0.17;

  /// Attitude controller: angular acceleration per error of roll and pitch [1/s^2].
  double stiffness = 86.0;
  /// Angular acceleration per rate about x and y [1/s].
  double damping = 15.0;
  /// Angular acceleration per error of the yaw rate [1/s].
  double yaw_damping = 10.0;
  /// Limits of the moments that the attitude controller asks for [N m].
  Eigen::Vector3d moment_max{1.0, 1.0, 0.2};

  /// Time from odometry to the effect of its command, a multiple of the integration's step [s].
  double command_delay = 0.0;
  /// External force in W [N].
  Eigen::Vector3d force = Eigen::Vector3d::Zero();

  double position_noise = 0.0;  ///< standard deviation per axis [m]
  double velocity_noise = 0.0;  ///< standard deviation per axis [m/s]
  double attitude_noise = 0.0;  ///< standard deviation per axis [rad]
  int seed = 1;
};

/// Integrates Newton's and Euler's equations by the midpoint rule in steps of half a millisecond. Shares nothing with
/// the other plants. The same calls give the same bits.
class RigidBodyPlant {
 public:
  /// Integration step [s].
  static constexpr double kStep = 0.0005;

  /// Hovers level at `position` with yaw 0.
  RigidBodyPlant(const RigidBodyOptions& options, const Eigen::Vector3d& position);

  /// Flies `period` seconds, a multiple of kStep, with the command; it acts after the delay.
  void advance(const AttitudeCommand& command, double period);

  /// From now on the external force in W is this one [N].
  void setForce(const Eigen::Vector3d& force) noexcept { options_.force = force; }

  VehicleState measure();  ///< odometry now, with noise
  VehicleState truth() const;
  double time() const noexcept { return static_cast<double>(step_) * kStep; }
  const Eigen::Vector3d& position() const noexcept { return motion_.position; }
  /// Thrust of all rotors [N].
  double thrust() const noexcept;
  /// Kinetic energy of translation and rotation, and potential energy over height 0 [J].
  double energy() const noexcept;

 private:
  using Rotors = Eigen::Array4d;
  struct Motion {
    Eigen::Vector3d position, velocity;
    Eigen::Quaterniond attitude;
    Eigen::Vector3d rates;  // about the body's axes [rad/s]
    Rotors speed;           // square root of the thrust [sqrt(N)]
  };
  struct Slope {
    Eigen::Vector3d acceleration, angular;
    Rotors speed;
  };
  struct Pending {
    std::int64_t step;  // from which it acts
    AttitudeCommand command;
  };

  Rotors demandedThrusts(const Motion& at) const;
  Slope slope(const Motion& at) const;
  static Motion moved(const Motion& from, const Motion& at, const Slope& slope, double h);

  RigidBodyOptions options_;
  Motion motion_;
  AttitudeCommand acting_;
  std::deque<Pending> pending_;
  std::int64_t step_ = 0;
  GaussianSource noise_;
};

}  // namespace polyfly
