#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "identification/flight_signals.hpp"

namespace polyfly {

/// Step of the grid on which the signs of an upset or of the ground are looked for [s].
constexpr double kPhaseStep = 0.05;

/// One piece of a flight on a grid of times; a signal that is not there is empty, one that pauses is NaN.
struct FlightGrid {
  /// First time [s].
  double from = 0.0;
  std::size_t size = 0;
  /// Measured values at the grid's times.
  std::vector<double> roll, pitch, airspeed, height;
  /// Size of the velocity, over ground where it is not known in space [m/s].
  std::vector<double> speed;
  /// Commands at the grid's times.
  std::vector<double> roll_cmd, pitch_cmd, yaw_rate_cmd, thrust_cmd;
  /// Means of the steps: rates about the body's axes [rad/s].
  std::vector<double> gyro_x, gyro_y, yaw_rate;
  /// Means of the steps: size of the specific force; along z alone where x or y is not known [m/s^2].
  std::vector<double> force;
  /// Greatest size of the specific force within the step [m/s^2].
  std::vector<double> force_peak;

  double time(std::size_t i) const { return from + kPhaseStep * static_cast<double>(i); }
};

/// The pieces between far steps of the signal that is sampled throughout; none where nothing is sampled often
/// enough.
std::vector<FlightGrid> flightGrids(const FlightSignals& signals);

}  // namespace polyfly
