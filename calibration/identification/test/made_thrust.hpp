#pragma once

#include <cstdint>
#include <vector>

#include "identification/flight_signals.hpp"

namespace polyfly::test {

/// What a made vehicle hides from the identification of its thrust curve.
struct MadeThrust {
  double mass = 1.5;  ///< [kg]
  /// Command over thrust in N at the voltage `full`.
  std::vector<double> curve = {0.12, 0.028, -0.0003};
  double lag = 0.06;    ///< of the motors [s]
  double delay = 0.02;  ///< [s]
  /// Drag against the climb rate [1/s].
  double drag = 0.15;
  /// The command counts times (voltage / full)^exponent.
  double exponent = 1.0;
  double full = 16.4;   ///< voltage at the start [V]
  double empty = 15.0;  ///< voltage at the end [V]
  /// Voltage that is lost at full command [V].
  double sag = 0.8;
  /// Standard deviation of the wind along the body's z, correlated over 1 s [m/s].
  double gust = 0.2;
  /// Standard deviation of the accelerometer's noise [m/s^2].
  double noise = 0.4;
  /// Scale of the accelerometer.
  double scale = 1.0;
  /// Standard deviation of the thrust that is asked for, by the weight.
  double excitation = 0.2;
  double duration = 60.0;  ///< [s]
  bool logs_voltage = true;
};

/// Command for a thrust in N at the voltage `full`.
double commandOf(const MadeThrust& made, double thrust);

/// Command for a thrust with a battery that gives `voltage` at the command `mean`, and sags as the vehicle's does. By
/// bisection.
double commandOf(const MadeThrust& made, double thrust, double voltage, double mean);

/// A flight that is asked to climb and descend while it holds its height loosely, with a law that knows the weight but
/// not the curve. The thrust of a command is found by bisection, so it shares nothing with the library.
FlightSignals makeThrustFlight(const MadeThrust& made, std::uint32_t seed);

}  // namespace polyfly::test
