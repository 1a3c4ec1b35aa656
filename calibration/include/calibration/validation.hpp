#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calibration/flight_log.hpp"
#include "calibration/lookup_times.hpp"
#include "calibration/replay.hpp"

namespace polyfly {

/// How far a map's parameter went, and how often out of its range.
struct ParameterUse {
  std::string name;
  std::string unit;
  double lower = 0.0;  ///< of the map [unit]
  double upper = 0.0;
  double least = 0.0;  ///< met in flight [unit]
  double greatest = 0.0;
  std::size_t outside = 0;  ///< samples beyond the range

  /// Distance from what was met to the nearer end of the range; negative beyond it [unit].
  double margin() const { return std::min(least - lower, upper - greatest); }
  /// The range that would have held the flight: as it is, or, where an end was passed, a tenth of what was
  /// met beyond.
  std::pair<double, double> proposedRange() const;
};

/// Greatest and root-mean-square difference of two series.
struct Difference {
  double max = 0.0;
  double rms = 0.0;
  double stamp = 0.0;  ///< where the greatest is [s]
};

struct AxisValidation {
  std::string axis;   ///< longitudinal, lateral, vertical
  std::string input;  ///< name and unit of what the map answers
  std::string input_unit;
  std::string map_path;
  std::size_t regions = 0;
  std::size_t visited = 0;                   ///< different regions that held a sample
  std::vector<std::uint32_t> never_visited;  ///< the others, by their number in the map
  std::size_t samples = 0;                   ///< samples with a reference
  std::size_t inside = 0;
  std::size_t outside_box = 0;        ///< a parameter out of its range
  std::size_t outside_partition = 0;  ///< in range, but in no region
  std::size_t not_finite = 0;
  std::vector<ParameterUse> parameters;

  std::size_t qp_compared = 0;
  std::size_t qp_failures = 0;  ///< samples inside the map where the online solver found no solution
  std::vector<std::array<double, 2>> qp_series;  ///< stamp [s] and |explicit - online| of each sample
  Difference qp;  ///< |explicit - online| of the axis' input, over samples inside the map

  LookupTimes lookups;
  Percentiles lookup_ns;           ///< of lookups.in_order
  Percentiles lookup_shuffled_ns;  ///< of lookups.shuffled

  Difference tracking;  ///< |position - reference| [m]
};

struct CommandValidation {
  std::size_t recorded = 0;
  std::size_t compared = 0;    ///< recorded commands with the stamp of a replayed sample
  std::size_t unmatched = 0;   ///< recorded commands that answer no recorded odometry
  std::size_t unanswered = 0;  ///< odometry without a recorded command
  std::array<Difference, 4>
      difference;               ///< roll, pitch [rad], yaw rate [rad/s], thrust [N], recorded - replayed
  double max_difference = 0.0;  ///< of the four, thrust per mass [rad, rad/s or m/s^2]
  std::size_t angle_violations = 0;
  std::size_t thrust_violations = 0;
  std::size_t yaw_rate_violations = 0;
  std::size_t not_finite = 0;
};

struct StatusValidation {
  std::array<std::size_t, 5> replayed{};  ///< samples by ControlStatus
  std::array<std::size_t, 5> recorded{};
  std::size_t compared = 0;
  std::size_t differing = 0;          ///< recorded status or regions differ from the replay's
  double max_theta_difference = 0.0;  ///< of any parameter, recorded - replayed
  Percentiles step_ns;                ///< of the control step in flight, as the node measured it
};

/// Mean error while the reference rests at the end of the flight.
struct HoldOffset {
  double from = 0.0;  ///< [s], stamps
  double to = 0.0;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();    ///< mean of position - reference [m]
  Eigen::Vector3d estimate = Eigen::Vector3d::Zero();  ///< mean of the disturbance estimate [m/s^2]
  std::optional<Eigen::Vector3d> disturbance;          ///< mean of the true one, where recorded [m/s^2]
};

struct ValidationReport {
  std::string source;
  std::size_t samples = 0;              ///< odometry messages that were replayed
  std::size_t tracked_samples = 0;      ///< of them, with a reference
  std::size_t outside_map_samples = 0;  ///< tracked, but some axis' parameters are not inside its map
  double coverage = 0.0;   ///< share of the tracked samples that all maps hold, 0 if there are none
  double duration = 0.0;   ///< first to last odometry [s]
  double top_speed = 0.0;  ///< [m/s]
  Difference tracking;     ///< |position - reference|, in space [m]
  std::array<AxisValidation, 3> axes;
  Percentiles lookup_ns;  ///< all axes
  CommandValidation commands;
  StatusValidation statuses;
  std::optional<HoldOffset> hold;  ///< none if the reference does not rest at the end

  std::size_t regionCount() const;
  std::size_t visitedCount() const;
  double maxQpDifference() const;
  std::size_t violationCount() const;
};

/// Judges a replay. Throws Error naming the map when its problem cannot be read.
ValidationReport validate(const FlightLog& log, const std::vector<ReplaySample>& samples,
                          const AxisMaps& maps, const MultirotorOptions& options);

/// Limits on a report; what is broken comes back as sentences, nothing when all is well.
struct Thresholds {
  double min_coverage = 0.99;            ///< share, 0..1
  double max_qp_difference = 1e-6;       ///< [unit of the axis' input]
  double max_command_difference = 1e-6;  ///< [rad, rad/s or m/s^2]
  std::size_t max_violations = 0;        ///< of bounds on the recorded commands
};
std::vector<std::string> brokenThresholds(const ValidationReport& report, const Thresholds& thresholds);

/// A page of text for a terminal.
std::string toText(const ValidationReport& report);

/// The flat numbers of `summary.json` first, then the details. README.md lists the keys.
std::string toJson(const ValidationReport& report);

}  // namespace polyfly
