#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace polyfly {

/// Deflections and throttle. A positive aileron (left less right) rolls to the right, a positive elevator
/// pitches down, a positive rudder yaws to the right.
struct Controls {
  double aileron = 0.0;   ///< [rad]
  double elevator = 0.0;  ///< [rad]
  double rudder = 0.0;    ///< [rad]
  double throttle = 0.0;  ///< [-], 0 to 1
};

/// A rigid aircraft and its aerodynamics, in the body's axes (forward, right, down). The values are those published
/// for the Techpod (2.6 m span) with the simulator RotorS. Geometry, coefficients and limits are from
/// fw_parameters.h. The masses, summed, and the inertia are from techpod.xacro.
struct Airframe {
  double mass = 2.75;  ///< [kg]
  /// Moments of inertia about x, y, z [kg m^2].
  Eigen::Vector3d inertia = Eigen::Vector3d(0.16632, 0.3899, 0.5243);
  /// Product of inertia: integral of x z [kg m^2].
  double inertia_xz = 0.0755;
  /// Wing span b [m].
  double span = 2.59;
  /// Wing area S [m^2].
  double area = 0.47;
  /// Wing chord c [m].
  double chord = 0.18;
  /// Density of the air [kg/m^3].
  double density = 1.225;
  /// Greatest angle of attack, in either direction; beyond it the coefficients stay constant [rad].
  double alpha_max = 0.27;
  /// Greatest deflection of a surface; an aileron has two surfaces [rad].
  double deflection_max = 0.349;
  double thrust_max = 14.7217;  ///< [N]

  // C_L = l0 + l1 alpha + l2 alpha^2 + l3 alpha^3, C_D = d0 + d1 alpha + d2 alpha^2 + d_beta beta^2
  double l0 = 0.2127, l1 = 10.8060, l2 = -46.8324, l3 = 60.6017;
  double d0 = 0.1360, d1 = -0.6737, d2 = 5.4546, d_beta = -0.3842;
  double y_beta = -0.3073;
  double roll_beta = -0.0154, roll_p = -0.1647, roll_r = 0.0117, roll_aileron = 0.0570;
  double pitch_0 = 0.0435, pitch_alpha = -2.9690, pitch_q = -106.1541, pitch_elevator = -6.1308;
  double yaw_beta = 0.0430, yaw_r = -0.0827, yaw_rudder = 0.06;

  Eigen::Matrix3d inertiaTensor() const;
};

struct BodyState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< (north, east, down) [m]
  /// Velocity over ground, in body axes [m/s].
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  /// Rotation from the body to the world.
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rates = Eigen::Vector3d::Zero();  ///< (p, q, r) [rad/s]
};

/// The air about the aircraft.
struct AirMotion {
  Eigen::Vector3d wind = Eigen::Vector3d::Zero();  ///< (north, east, down) [m/s]
  Eigen::Vector3d gust = Eigen::Vector3d::Zero();  ///< body axes [m/s]
  double roll_gust = 0.0;                          ///< [rad/s]
};

struct Wrench {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< body axes [N]
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< about the centre of mass, body axes [N m]
};

/// Velocity through the air, in the body's axes [m/s].
Eigen::Vector3d airVelocity(const BodyState& state, const AirMotion& air);

/// Of air and thrust; no gravity. The deflections are limited as the surfaces are.
Wrench wrenchOf(const Airframe& airframe, const Eigen::Vector3d& air_velocity, const Eigen::Vector3d& rates,
                const Controls& controls);

/// One step of the classical Runge-Kutta method; controls and air are held.
BodyState advance(const Airframe& airframe, const BodyState& state, const Controls& controls,
                  const AirMotion& air, double duration);

/// Straight, level, steady flight.
struct Trim {
  double alpha = 0.0;  ///< also the pitch angle [rad]
  Controls controls;
  double residual = 0.0;  ///< largest acceleration left [m/s^2, rad/s^2]
};

/// By Newton's method, at an airspeed [m/s] at which the wing carries the weight.
Trim trimLevel(const Airframe& airframe, double airspeed);

/// Roll, pitch, yaw [rad].
Eigen::Vector3d eulerAngles(const Eigen::Quaterniond& attitude);
Eigen::Quaterniond attitudeOf(double roll, double pitch, double yaw);

}  // namespace polyfly
