#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "identification/fit_loop.hpp"
#include "identification/flight_signals.hpp"

namespace polyfly {

/// What is known of a multirotor before its motion is looked at (Eq. 37).
struct MotionOptions {
  double gravity = 9.8066;                         ///< [m/s^2]
  double mass = 0.0;                               ///< [kg]; 0 where thrust_cmd is not in newtons
  Eigen::Vector3d drag = Eigen::Vector3d::Zero();  ///< mass-normalised, along W [1/s]
  double smoothing = 0.1;                          ///< half width of the mean over velocities [s]
  std::vector<TimeWindow> windows;                 ///< the whole record if empty
};

/// Accelerations in W (z up) of one flight, all through the same sliding mean.
struct Motion {
  std::string source;
  bool thrust_known = false;  ///< from thrust_cmd and the mass; else from the vertical acceleration itself
  std::vector<double> time;   ///< [s]
  std::vector<std::size_t>
      starts;                     ///< first sample of each stretch without a pause, and the number of samples
  Eigen::MatrixX3d acceleration;  ///< [m/s^2]
  Eigen::MatrixX3d expected;      ///< by thrust, attitude and gravity, without drag [m/s^2]
  Eigen::MatrixX3d velocity;      ///< [m/s]
  Eigen::VectorXd lift;           ///< vertical part of thrust_cmd, in its unit; 0 if there is none
};

/// From vx, vy, vz, roll, pitch, yaw, and thrust_cmd if a mass is given. Throws Error naming source and
/// signal, or when no stretch is long enough.
Motion motionOf(const FlightSignals& signals, const MotionOptions& options);

/// What acts along one axis and the model does not explain.
struct DisturbanceBound {
  std::string axis;                  ///< x, y, z
  double mean = 0.0;                 ///< [m/s^2]
  double deviation = 0.0;            ///< [m/s^2]
  double least = 0.0;                ///< bound below: `share` of the time within, with the stated confidence
  double greatest = 0.0;             ///< bound above
  double confidence = 0.0;           ///< reached; less than asked where the record is too short
  double independent_samples = 0.0;  ///< as many independent ones would tell as much
  std::vector<std::pair<double, double>> quantiles;  ///< share and value [m/s^2]
  std::vector<std::string> warnings;                 ///< sentences
};

struct BoundOptions {
  double share = 0.99;       ///< of the time that the bound holds, on each side half of the rest outside
  double confidence = 0.95;  ///< that it does
};

/// Bounds on acceleration minus what thrust, attitude, gravity and drag explain, for each axis; z only where
/// the thrust is known. Order statistics at the ranks that the binomial distribution of the independent
/// samples asks for.
std::vector<DisturbanceBound> boundDisturbance(const Motion& motion, const MotionOptions& options,
                                               const BoundOptions& bound);

/// Drag coefficients A_x, A_y, and A_z where the thrust is known [1/s], each with the mean disturbance beside
/// it; names drag_x, offset_x ...
std::vector<FittedParameter> fitDrag(const Motion& motion);

/// Mass [kg] from the vertical part of a thrust command in newtons, and the command that holds the vehicle
/// [N]; names mass, hover_thrust. Throws Error if there is no thrust_cmd.
std::vector<FittedParameter> fitMass(const Motion& motion, const MotionOptions& options);

/// Wind and scale of the airspeed from velocity over ground and airspeed alone (wind triangle without
/// heading): |v_ground - w| = scale * airspeed. Names wind_north, wind_east [m/s], airspeed_scale. `warnings`
/// says where the flight did not turn enough. Throws Error.
std::vector<FittedParameter> fitWind(const FlightSignals& signals, const std::vector<TimeWindow>& windows,
                                     std::vector<std::string>* warnings);

}  // namespace polyfly
