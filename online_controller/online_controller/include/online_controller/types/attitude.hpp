#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace polyfly {

/// Roll, pitch and yaw of a body, rotations in the order z-y'-x'' (yaw first) [rad].
struct EulerAngles {
  double roll = 0.0;
  double pitch = 0.0;
  double yaw = 0.0;
};

/// Roll and pitch, either about the body's axes or, with yaw taken out, about those of the world [rad].
struct TiltAngles {
  double roll = 0.0;
  double pitch = 0.0;
};

/// angle' = (gain command - angle) / time about roll and pitch, as the law predicts them.
struct TiltModel {
  double roll_gain = 0.9;    ///< [1]
  double roll_time = 0.25;   ///< [s]
  double pitch_gain = 0.9;   ///< [1]
  double pitch_time = 0.25;  ///< [s]
};

/// `attitude` rotates body to world and has unit length.
EulerAngles eulerAngles(const Eigen::Quaterniond& attitude) noexcept;

/// The inverse of eulerAngles.
Eigen::Quaterniond attitudeOf(const EulerAngles& angles) noexcept;

/// The same angle in [-pi, pi).
double wrapAngle(double angle) noexcept;

/// Eq. 40: tilt in the world-aligned frame to tilt in the frame turned by `yaw`.
TiltAngles worldToBodyTilt(const TiltAngles& world, double yaw) noexcept;

/// Inverse of Eq. 40.
TiltAngles bodyToWorldTilt(const TiltAngles& body, double yaw) noexcept;

constexpr double kLeastTiltCosine = 0.5;  ///< a tilt of 60 degrees

/// Derivatives of the angles while the body turns at `rates` about its axes [rad/s]. The cosine of the pitch counts as at least
/// kLeastTiltCosine.
EulerAngles eulerRates(const EulerAngles& angles, const Eigen::Vector3d& rates) noexcept;

/// Derivative of bodyToWorldTilt(roll and pitch, yaw) while the vehicle turns at `rates` about its body's axes [rad/s], as
/// eulerRates.
TiltAngles worldTiltRate(const EulerAngles& angles, const Eigen::Vector3d& rates) noexcept;

/// cos(roll) cos(pitch), at least kLeastTiltCosine, so that the thrust of Eq. 41 stays finite and positive
/// however far the vehicle is tilted.
double tiltCosine(const TiltAngles& tilt) noexcept;

/// First line of Eq. 41, mass-normalised thrust [m/s^2]: (T + g) / tiltCosine(tilt) + acceleration_z.
double compensatedThrust(double thrust, const TiltAngles& tilt, double gravity,
                         double acceleration_z) noexcept;

/// Second and third line of Eq. 41: the tilt that gives the specific force g * angle under the thrust
/// `total_thrust` [m/s^2] instead of under g. `acceleration_x`, `acceleration_y` are the desired
/// accelerations in the body's heading frame [m/s^2]. (The chapter prints z for the first of them, where x is
/// meant.)
TiltAngles compensatedTilt(const TiltAngles& tilt, double total_thrust, double gravity, double acceleration_x,
                           double acceleration_y) noexcept;

}  // namespace polyfly
