#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "identification/flight_signals.hpp"

namespace polyfly::test {

constexpr double kMass = 1.52;       ///< [kg]
constexpr double kGravity = 9.8066;  ///< [m/s^2]

/// What a made motion hides from the fits.
struct MadeMotion {
  double duration = 120.0;               /// [s]
  Eigen::Vector3d drag{0.3, 0.2, 0.15};  /// [1/s]
  /// Standard deviation of the disturbance, correlated over 0.5 s [m/s^2].
  double gust = 0.2;
  /// Standard deviation of the velocity noise [m/s].
  double noise = 0.005;
  /// Step of the disturbance along x in the second half [m/s^2].
  double step = 0.0;
  /// True: the drag acts along heading, left and up of the body.
  bool drag_turns = false;
};

/// A multirotor that tilts and turns, by Euler's method in small steps; yaw wraps. `gusts` are the disturbances along x.
FlightSignals makeMotion(const MadeMotion& made, std::uint32_t seed, std::vector<double>* gusts = nullptr);

}  // namespace polyfly::test
