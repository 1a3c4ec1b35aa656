#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "report/report.hpp"
#include "validation/difference.hpp"
#include "validation/flight_log.hpp"
#include "validation/lookup_times.hpp"
#include "validation/map_use.hpp"
#include "validation/parameters_told.hpp"
#include "validation/replay.hpp"

namespace polyfly {

/// A stretch of the flight, of consecutive samples, outside one axis' map.
struct Excursion {
  /// Stamp of the first sample [s].
  double from = 0.0;
  /// Stamp of the last sample [s].
  double to = 0.0;
  std::size_t samples = 0;
  /// Look-up status of the first sample.
  LookupStatus cause = LookupStatus::kInside;
  /// First parameter out of its range. Empty if none is.
  std::string parameter;
  /// Greatest distance of that parameter beyond its range [its unit].
  double beyond = 0.0;
  std::string unit;
  /// What the controller did: samples by ControlStatus.
  std::array<std::size_t, kControlStatusCount> statuses{};
};

/// One axis: how its map was used, and whether it answered as the online solver does.
struct AxisValidation : MapUse {
  /// Name of the axis: longitudinal, lateral or vertical.
  std::string axis;
  /// Name of the input that the map gives.
  std::string input;
  /// Unit of the input that the map gives.
  std::string input_unit;
  std::vector<Excursion> excursions;

  /// 0 for a map of a minimum-peak robust MPC.
  std::size_t qp_compared = 0;
  /// Samples inside the map where the online solver found no solution.
  std::size_t qp_failures = 0;
  /// Stamp [s] and |explicit - online| of each sample.
  std::vector<std::array<double, 2>> qp_series;
  /// Stamp [s] and distances to face and edge of each sample (see MapUse).
  std::vector<std::array<double, 3>> edge_series;
  /// Difference |explicit - online| of the axis' input, over samples inside the map.
  Difference qp;

  /// See measureLookups [ns].
  std::vector<double> lookup_times;
  Percentiles lookup_ns;

  /// Tracking error |position - reference| [m].
  Difference tracking;
};

struct CommandValidation {
  std::size_t recorded = 0;
  /// Recorded commands with the stamp of a replayed sample.
  std::size_t compared = 0;
  /// Recorded commands that answer no recorded odometry.
  std::size_t unmatched = 0;
  /// Odometry messages without a recorded command.
  std::size_t unanswered = 0;
  /// Roll, pitch [rad], yaw rate [rad/s], thrust [N], recorded - replayed.
  std::array<Difference, 4> difference;
  /// Greatest of the four differences, with thrust per mass [rad, rad/s or m/s^2].
  double max_difference = 0.0;
  std::size_t angle_violations = 0;
  std::size_t thrust_violations = 0;
  std::size_t yaw_rate_violations = 0;
  std::size_t not_finite = 0;
};

/// A stretch whose commands are not compared. It ends where the commands agree again, or with the record.
struct IncomparableStretch {
  Ignorance cause = Ignorance::kMissing;
  double from = 0.0;  ///< stamp of the first sample [s]
  double to = 0.0;    ///< stamp of the last sample [s]
  std::size_t samples = 0;
};

struct StatusValidation {
  /// Replayed samples by ControlStatus.
  std::array<std::size_t, kControlStatusCount> replayed{};
  /// Recorded samples by ControlStatus.
  std::array<std::size_t, kControlStatusCount> recorded{};
  std::size_t compared = 0;
  /// Samples whose recorded status or regions differ from the replay's.
  std::size_t differing = 0;
  /// Greatest difference recorded - replayed of any parameter.
  double max_theta_difference = 0.0;
  /// Greatest difference of an axis' recorded input to the law of its map at the recorded parameters, over the samples
  /// that a map answered [rad or m/s^2].
  double max_input_difference = 0.0;
  /// Time of the control step in flight, as the node measured it [ns].
  Percentiles step_ns;
};

/// Mean error while the reference rests at the end of the flight.
struct HoldOffset {
  double from = 0.0;  ///< [s], stamps
  double to = 0.0;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< mean of position - reference [m]
};

/// What a report says in one word.
enum class Verdict {
  kPassed,    ///< all thresholds hold, and nothing raises doubts
  kDoubtful,  ///< all thresholds hold, but there are warnings
  kFailed,    ///< a threshold is broken
};

struct ValidationReport {
  std::string source;
  /// How much of the recording was read. None if the log is no file.
  std::optional<RecordingShare> share;
  /// Odometry messages that were replayed.
  std::size_t samples = 0;
  /// Replayed odometry messages with a reference.
  std::size_t tracked_samples = 0;
  /// Tracked samples with the parameters of some axis outside its map.
  std::size_t outside_map_samples = 0;
  /// Time in which some axis had no answer of its map [s].
  double outside_map_time = 0.0;
  /// Share of the tracked samples that all maps hold; 0 if there are none.
  double coverage = 0.0;
  /// Time from first to last odometry, without far steps of its clock [s].
  double duration = 0.0;
  double top_speed = 0.0;  ///< [m/s]
  /// Tracking error |position - reference| in space [m].
  Difference tracking;
  std::array<AxisValidation, 3> axes;
  /// Look-up times of all axes [ns].
  Percentiles lookup_ns;
  CommandValidation commands;
  StatusValidation statuses;
  std::vector<IncomparableStretch> incomparable;
  /// Offset at the final rest. None if the reference does not rest at the end.
  std::optional<HoldOffset> hold;

  /// What the controller told of its parameters. None if that was not recorded.
  std::optional<ParametersTold> parameters;

  /// Sentences on why this record may not say what it seems to say.
  std::vector<std::string> warnings;
  /// Sentences of brokenThresholds, where they were asked for.
  std::vector<std::string> broken;

  Verdict verdict() const;
  /// Whether nothing of the recording is known to be lost or altered.
  bool isWhole() const;
  std::size_t regionCount() const;
  std::size_t visitedCount() const;
  double maxQpDifference() const;
  std::size_t violationCount() const;
};

/// Judges replayed flights with the same maps, at least one. Of several: counts together, greatest differences, root mean
/// squares over all samples; no offset at rest, and neither warnings nor parameters. Throws Error naming the map when its
/// problem cannot be read.
ValidationReport validate(const std::vector<ReplayedFlight>& flights, const AxisMaps& maps);

inline ValidationReport validate(const FlightLog& log, const std::vector<ReplaySample>& samples,
                                 const AxisMaps& maps, const MultirotorOptions& options) {
  return validate({{log, samples, options}}, maps);
}

/// Limits on a report; what is broken comes back as sentences, nothing when all is well.
struct Thresholds {
  /// Least coverage, a share 0..1.
  double min_coverage = 0.99;
  double max_qp_difference = 1e-6;                    ///< [unit of the axis' input]
  double max_command_difference = kCommandTolerance;  ///< [rad, rad/s or m/s^2]
  /// Greatest number of recorded commands beyond their bounds.
  std::size_t max_violations = 0;
};
/// Greatest difference of a recorded input to the law of its map at the recorded parameters, of another version.
constexpr double kLawTolerance = 1e-9;
std::vector<std::string> brokenThresholds(const ValidationReport& report, const Thresholds& thresholds);

/// The flat numbers of `summary.json` first, then the details. README.md lists the keys.
Json jsonOf(const ValidationReport& report);

/// Of several flights: the numbers of all together, and those of each under `flights`.
Json jsonOf(const ValidationReport& all, const std::vector<ValidationReport>& flights);

/// What page and console show, without pictures.
Report reportOn(const ValidationReport& report);

}  // namespace polyfly
