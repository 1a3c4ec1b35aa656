#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "bags/recording_share.hpp"
#include "online_controller/flight/command_filter.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// What a safety filter receives in a flight, and its own account where it flew. Each list is in the order of arrival.
struct FilterLog {
  struct Odometry {
    double received = 0.0;  ///< by the recorder's clock [s]
    VehicleState state;
  };
  struct Wish {
    double received = 0.0;  ///< by the recorder's clock [s]
    double stamp = 0.0;     ///< of its header [s]; 0: none
    AttitudeCommand command;
  };
  /// A message of `filter_status`.
  struct Status {
    double stamp = 0.0;  ///< of the command, or the time where none came [s]
    FilterStatus status = FilterStatus::kNoState;
    std::array<double, 3> input{};  ///< world x, y, z [m/s^2]
  };

  /// File of the record, for messages and titles.
  std::string source;
  /// Every irregularity of the file, as clauses without its name.
  std::vector<std::string> remarks;
  /// How much of the recording was read. None if the log is no file.
  std::optional<RecordingShare> share;
  std::vector<Odometry> odometry;
  std::vector<Wish> wishes;
  /// Empty where the filter did not fly.
  std::vector<Status> statuses;
};

/// Parameters of the node, as online_controller/SAFETY_FILTER.md describes them.
struct FilterTiming {
  double silence_periods = 3.0;  ///< [samples], 1..100
  double stale_periods = 3.0;    ///< [samples], 1..100
};

/// The filter's answer in one period.
struct FilterSample {
  double time = 0.0;  ///< by the recorder's clock [s]
  /// Stamp of the command. Empty where none came.
  std::optional<double> stamp;
  /// Whether the command came, and is finite.
  bool wished = false;
  /// Until the next answer, or for the silence that the node accepts [s].
  double held = 0.0;
  VehicleState state;
  FilterReport report;
  /// Distance of the state to the edge of each axis' safe set; see edgeDistance. NaN without a map or a state.
  std::array<double, 3> distance{};
};

struct FilterReplay {
  std::vector<FilterSample> samples;
  /// Commands that came too soon after another, and were dropped as the node does.
  std::size_t early = 0;
};

/// Distance of xi to the nearest half-space of the safe set, negative beyond one. States count in halves of their ranges,
/// so that a range has the length 2. `xi` holds problem.augmentedCount() numbers.
double edgeDistance(const SafetyFilterProblem& problem, const double* xi);

/// Runs the record through the filter, by the node's rules. The order is that of arrival, and odometry counts as the
/// earlier of two that arrived at one time. A silence is followed for at most a minute. The states are those of the record, whatever the filter answers. Throws Error
/// when there is no command.
FilterReplay replayFilter(const FilterLog& log, const FilterTiming& timing, CommandFilter& filter);

}  // namespace polyfly
