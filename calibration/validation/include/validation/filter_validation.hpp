#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "report/report.hpp"
#include "validation/filter_replay.hpp"

namespace polyfly {

constexpr int kFilterStatusCount = 5;
constexpr std::array<const char*, 3> kFilterAxes = {"x", "y", "z"};

/// A stretch of time in which the filter changed the commands of one axis.
struct FilterAction {
  std::size_t axis = 0;   ///< world x, y, z
  double from = 0.0;      ///< since the first answer [s]
  double to = 0.0;        ///< since the first answer [s]
  std::size_t count = 0;  ///< changed commands
  /// Worst of the stretch.
  FilterStatus status = FilterStatus::kChanged;
  double change = 0.0;    ///< of the greatest size, sent minus wished [m/s^2]
  double distance = 0.0;  ///< least; see edgeDistance
};

/// One axis of the world that has a map.
struct FilterAxisValidation {
  std::size_t axis = 0;
  std::string problem;                           ///< name
  std::size_t changed = 0;                       ///< answers other than the wish
  double changed_time = 0.0;                     ///< [s]
  double greatest_change = 0.0;                  ///< [m/s^2]
  double outside_time = 0.0;                     ///< state outside of the safe set [s]
  std::optional<double> first_outside;           ///< since the first answer [s]
  double unanswered_time = 0.0;                  ///< state where the map has no answer [s]
  double least_distance = 0.0;                   ///< see edgeDistance
  double least_distance_at = 0.0;                ///< since the first answer [s]
  std::array<double, 2> least{}, greatest{};     ///< of position [m] and velocity [m/s]
  std::array<std::array<double, 2>, 2> range{};  ///< lower, upper of position [m] and velocity [m/s]
  std::array<double, 2> input_range{};           ///< lower, upper [m/s^2]
};

/// What was recorded in flight against the replay.
struct FilterComparison {
  std::array<std::size_t, kFilterStatusCount> recorded{};  ///< statuses
  std::size_t compared = 0;
  /// With another status, or with an input that differs by more than rounding.
  std::size_t differing = 0;
  /// Replayed commands between the first and last recorded status that have none.
  std::size_t missing = 0;
  double greatest_difference = 0.0;  ///< of an axis' input [m/s^2]
};

struct FilterValidation {
  std::string source;
  double duration = 0.0;       ///< [s]
  double period = 0.0;         ///< of the maps [s]
  double median_period = 0.0;  ///< between the answers [s]
  std::size_t early = 0;
  std::array<std::size_t, kFilterStatusCount> replayed{};  ///< answers
  double changed_time = 0.0;                               ///< on any axis, with or without a wish [s]
  double without_wish_time = 0.0;                          ///< [s]
  double without_state_time = 0.0;                         ///< [s]
  std::vector<FilterAxisValidation> axes;
  std::vector<FilterAction> actions;
  /// Empty where the filter did not fly.
  std::optional<FilterComparison> comparison;
  std::optional<RecordingShare> share;
  /// What is to be looked at, as sentences. Empty: passed.
  std::vector<std::string> findings;

  bool hasPassed() const { return findings.empty(); }
};

/// Evaluates the replay of a log.
FilterValidation validateFilter(const FilterLog& log, const FilterReplay& replay,
                                const CommandFilter& filter);

/// The content of `summary.json`, keys explained in README.md.
Json jsonOf(const FilterValidation& validation);

/// What page and console show, without pictures.
Report reportOn(const FilterValidation& validation);

/// Writes `index.html` and `summary.json` into the folder, which is made where it is missing. Throws Error naming the file.
void writeFilterReport(const FilterValidation& validation, const FilterReplay& replay,
                       const std::string& folder);

}  // namespace polyfly
