#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identification/flight_signals.hpp"
#include "identification/loop_response.hpp"

namespace polyfly {

/// What the curve is fitted to, row by row.
struct ThrustSamples {
  Eigen::VectorXd time;  ///< [s]
  /// Thrust command behind lag and delay [1].
  Eigen::VectorXd command;
  /// Its change with the lag [1/s].
  Eigen::VectorXd by_lag;
  Eigen::VectorXd force;  ///< along the body's z [N]
  /// Mass times the speed along the body's z [N s]. Empty where the log does not tell it, or it hardly moves.
  Eigen::VectorXd climb;
  /// What changes with the battery: logarithm of voltage by mean voltage, or the share of the flight that has passed,
  /// from -0.5 to 0.5. Empty where the voltage is known to be constant.
  Eigen::VectorXd battery;
  /// First row of each stretch, and the number of rows.
  std::vector<Eigen::Index> starts;

  Eigen::Index rows() const { return time.size(); }
};

/// One flight, before the lag is known.
struct ThrustRecord {
  std::string source;
  std::vector<LoopSegment> segments;
  Eigen::VectorXd time;
  Eigen::VectorXd force;
  /// Empty where the log does not tell it.
  Eigen::VectorXd climb;
  /// Mean over 10 s [V]. Empty where the log does not tell it.
  Eigen::VectorXd voltage;
  /// Mean vertical acceleration that the accelerometer shows, by gravity; 1 if there is no accelerometer or attitude.
  double accelerometer_scale = 1.0;
};

/// Throws Error, see fitThrust.
ThrustRecord thrustRecordOf(const FlightSignals& signals, const std::vector<TimeWindow>& windows, double mass,
                            double gravity);

/// The command of a record behind a first-order lag and a delay, at its rows. It begins each stretch settled.
Eigen::VectorXd laggedCommand(const ThrustRecord& record, const LoopShape& shape);

/// The rows of some stretches of rows: first row and the row behind the last of each.
ThrustSamples rowsOf(const ThrustSamples& samples,
                     const std::vector<std::pair<Eigen::Index, Eigen::Index>>& stretches);

/// The rows of all, one after the other.
ThrustSamples stacked(const std::vector<ThrustSamples>& all);

}  // namespace polyfly
