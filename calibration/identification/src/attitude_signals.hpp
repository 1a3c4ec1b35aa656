#pragma once

#include <Eigen/Core>
#include <string>

#include "identification/flight_signals.hpp"

namespace polyfly {

/// The samples of a signal that can be used, see cleaned. Throws Error naming source and signal if there are none.
TimeSeries usableSignal(const FlightSignals& signals, const std::string& name);

/// Attitude at any time. Sine and cosine of yaw are interpolated, because the angle itself may wrap.
class AttitudeSignals {
 public:
  /// From roll, pitch, yaw. Throws Error where one is missing.
  explicit AttitudeSignals(const FlightSignals& signals);

  double yaw(double time) const;  ///< [rad]

  /// The body's z axis in W.
  Eigen::Vector3d up(double time) const;

 private:
  TimeSeries roll_;
  TimeSeries pitch_;
  TimeSeries yaw_sine_;
  TimeSeries yaw_cosine_;
};

}  // namespace polyfly
