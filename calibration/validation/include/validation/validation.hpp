#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "validation/difference.hpp"
#include "validation/flight_log.hpp"
#include "validation/lookup_times.hpp"
#include "validation/map_comparison.hpp"
#include "validation/map_proposal.hpp"
#include "validation/map_use.hpp"
#include "validation/online_oracle.hpp"
#include "validation/replay.hpp"

namespace polyfly {

/// A stretch of the flight, of consecutive samples, outside one axis' map.
struct Excursion {
  double from = 0.0;  ///< stamps of its first and last sample [s]
  double to = 0.0;
  std::size_t samples = 0;
  LookupStatus cause = LookupStatus::kInside;  ///< of the first sample
  std::string parameter;                       ///< first one out of its range; empty if none is
  double beyond = 0.0;  ///< greatest distance of that parameter beyond its range [its unit]
  std::string unit;
  /// What the controller did: samples by ControlStatus.
  std::array<std::size_t, kControlStatusCount> statuses{};
};

/// One axis: how its map was used, and whether it answered as the online solver does.
struct AxisValidation : MapUse {
  std::string axis;   ///< longitudinal, lateral, vertical
  std::string input;  ///< name and unit of what the map answers
  std::string input_unit;
  std::string map_path;
  std::vector<Excursion> excursions;

  std::size_t qp_compared = 0;
  std::size_t qp_failures = 0;  ///< samples inside the map where the online solver found no solution
  std::vector<std::array<double, 2>> qp_series;    ///< stamp [s] and |explicit - online| of each sample
  std::vector<std::array<double, 3>> edge_series;  ///< stamp [s], distances to face and edge (see MapUse)
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
  /// roll, pitch [rad], yaw rate [rad/s], thrust [N], recorded - replayed.
  std::array<Difference, 4> difference;
  double max_difference = 0.0;  ///< of the four, thrust per mass [rad, rad/s or m/s^2]
  std::size_t angle_violations = 0;
  std::size_t thrust_violations = 0;
  std::size_t yaw_rate_violations = 0;
  std::size_t not_finite = 0;
};

struct StatusValidation {
  std::array<std::size_t, kControlStatusCount> replayed{};  ///< samples by ControlStatus
  std::array<std::size_t, kControlStatusCount> recorded{};
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
  double duration = 0.0;   ///< first to last odometry, without far steps of its clock [s]
  double top_speed = 0.0;  ///< [m/s]
  Difference tracking;     ///< |position - reference|, in space [m]
  std::array<AxisValidation, 3> axes;
  Percentiles lookup_ns;  ///< all axes
  CommandValidation commands;
  StatusValidation statuses;
  std::optional<HoldOffset> hold;  ///< none if the reference does not rest at the end

  std::vector<std::string> warnings;  ///< sentences: why this record may not say what it seems to say

  std::vector<MapComparison> comparisons;  ///< with other maps, where compareMaps was asked
  std::vector<MapProposal> proposals;      ///< where proposeMap was asked

  std::size_t regionCount() const;
  std::size_t visitedCount() const;
  double maxQpDifference() const;
  std::size_t violationCount() const;
};

/// Judges a replay; `maker` where maps are of a minimum-peak robust MPC. Throws Error naming the map when its
/// problem cannot be read, or when it needs a maker and there is none.
ValidationReport validate(const FlightLog& log, const std::vector<ReplaySample>& samples,
                          const AxisMaps& maps, const MultirotorOptions& options,
                          const OracleMaker& maker = {});

/// Several flights with the same maps as one report: counts and windows together, greatest differences, root
/// mean squares over all samples, no offset at rest. `flights` must not be empty. Of one flight, itself.
ValidationReport together(const std::vector<ValidationReport>& flights);

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

/// Of several flights: the numbers of all together, and those of each under `flights`.
std::string toJson(const ValidationReport& all, const std::vector<ValidationReport>& flights);

}  // namespace polyfly
