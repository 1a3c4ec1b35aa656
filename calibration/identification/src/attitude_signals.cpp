#include "attitude_signals.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "polyfly_base/error.hpp"

namespace polyfly {

TimeSeries usableSignal(const FlightSignals& signals, const std::string& name) {
  TimeSeries series = cleaned(signals.at(name));
  if (series.time.empty()) throw Error(signals.source + ": " + name + ": no sample");
  return series;
}

AttitudeSignals::AttitudeSignals(const FlightSignals& signals)
    : roll_(usableSignal(signals, "roll")),
      pitch_(usableSignal(signals, "pitch")),
      yaw_sine_(usableSignal(signals, "yaw")),
      yaw_cosine_(yaw_sine_) {
  for (double& value : yaw_sine_.value) value = std::sin(value);
  for (double& value : yaw_cosine_.value) value = std::cos(value);
}

double AttitudeSignals::yaw(double time) const {
  return std::atan2(interpolated(yaw_sine_, time), interpolated(yaw_cosine_, time));
}

Eigen::Vector3d AttitudeSignals::up(double time) const {
  return Eigen::AngleAxisd(yaw(time), Eigen::Vector3d::UnitZ()) *
         (Eigen::AngleAxisd(interpolated(pitch_, time), Eigen::Vector3d::UnitY()) *
          (Eigen::AngleAxisd(interpolated(roll_, time), Eigen::Vector3d::UnitX()) *
           Eigen::Vector3d::UnitZ()));
}

}  // namespace polyfly
