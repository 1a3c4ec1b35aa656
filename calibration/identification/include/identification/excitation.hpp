#pragma once

#include <string>
#include <vector>

#include "identification/loop_record.hpp"

namespace polyfly {

/// How a stretch is found in which the command moves enough to learn from.
struct ExcitationSearchOptions {
  /// Half width of the stretch over which the deviation of the command counts as activity [s].
  double half_width = 1.0;
  /// Threshold as a share of the activity that is exceeded 10 % of the time.
  double threshold_share = 0.25;
  /// Threshold as a share of the activity above which lies half of its energy. The greater threshold counts.
  double energy_share = 0.06;
  /// Margin before and after a window, so that the response is included [s].
  double margin = 0.5;
  /// Least length of a window. Shorter windows are left out [s].
  double least_window = 3.0;
};

/// What of a flight is used, and why not the rest.
struct ExcitationChoice {
  std::vector<TimeWindow> windows;
  std::vector<RejectedWindow> rejected;
  /// Deviation of the command around each time, in its unit.
  TimeSeries activity;
  /// Threshold of the activity.
  double threshold = 0.0;
};

/// Finds the windows in which the vehicle flies and the command is active.
/// Clean record.
ExcitationChoice chooseExcitation(const LoopRecord& record, const ExcitationSearchOptions& options);

/// Greatest correlation coefficient in size, with its sign, of response and command over lags 0 ..
/// greatest_lag.
double bestCorrelation(const TimeSeries& command, const TimeSeries& response, const TimeWindow& window,
                       double greatest_lag);

/// The value in force at a time; the first one before that.
double heldValue(const TimeSeries& series, double time);

}  // namespace polyfly
