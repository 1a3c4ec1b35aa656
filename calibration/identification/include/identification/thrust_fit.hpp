#pragma once

#include <string>
#include <vector>

#include "identification/flight_signals.hpp"
#include "identification/motion.hpp"

namespace polyfly {

/// What is known of a multirotor before its thrust curve is identified.
struct ThrustOptions {
  double mass = 0.0;        ///< [kg], > 0
  double gravity = 9.8066;  ///< [m/s^2]
  /// Degree of the polynomial, 1 to 3. 0: the greatest whose highest coefficient differs from zero.
  int degree = 0;
};

/// The battery's voltage while the flights that a curve comes from were flown, in the mean over 10 s.
struct FlownVoltage {
  bool logged = false;
  /// Voltage that the curve is for [V].
  double mean = 0.0;
  double least = 0.0;     ///< [V]
  double greatest = 0.0;  ///< [V]
  /// True: the command for a thrust depends on it by more than 3 % over this range.
  bool matters = false;
};

/// A thrust command, a share of full thrust from 0 to 1, over the thrust F along the body's z.
struct IdentifiedCurve {
  /// Coefficients of command = c[0] + c[1] F + c[2] F^2 + ..., F in N.
  std::vector<double> polynomial;
  /// Thrusts of the parameters command_1, command_2 ...; the first and the last are the ends of what was flown [N].
  std::vector<double> thrusts;
  double mass = 0.0;  ///< [kg]
  FlownVoltage voltage;
  /// First-order lag from the command to the thrust [s].
  double lag = 0.0;
  /// Delay in addition to it [s].
  double delay = 0.0;
  double fit_percent = 0.0;
  /// On data that the model was not fitted to: quarters of one flight, or each of several flights.
  double validation_percent = 0.0;
  /// Sentences on why no controller may be given this curve.
  std::vector<std::string> reasons;

  bool supported() const { return reasons.empty(); }
};

struct ThrustFit : MotionFit {
  IdentifiedCurve curve;
  /// Parameters of each flight, if there are several.
  std::vector<std::vector<FittedParameter>> flights;
};

/// Flights of one vehicle, with the windows to use of each. No windows: all of the flight.
struct ThrustFlights {
  std::vector<FlightSignals> signals;
  std::vector<std::vector<TimeWindow>> windows;
};

/// Fits the thrust along the body's z, mass times the specific force, to thrust_cmd. The model is a lag, a delay and
/// the inverse of a polynomial in the thrust. So noise of the accelerometer does not make the curve flatter. Further
/// unknowns are a drag against the climb rate along the body's z, and the effect of the battery. The command counts
/// times (voltage / mean voltage)^exponent. Without a voltage in all flights, it counts times a factor that drifts in
/// time.
///
/// Parameters are the commands at the thrusts of the curve, hover_command, voltage_exponent or drift, drag_climb [1/s].
/// Of several flights they are random-effects means, and the polynomial goes through them.
///
/// Throws Error naming source and signal. Also where thrust_cmd exceeds 1 or is negative, where the thrust does not
/// rise with it, or no stretch is long enough.
ThrustFit fitThrust(const ThrustFlights& flights, const ThrustOptions& options);

}  // namespace polyfly
