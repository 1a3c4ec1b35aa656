#pragma once

#include <string>
#include <vector>

#include "identification/loop_record.hpp"

namespace polyfly {

/// How a stretch is found in which the command moves enough to learn from.
struct ExcitationSearchOptions {
  double half_width = 1.0;        ///< of the stretch whose deviation counts as activity [s]
  double threshold_share = 0.25;  ///< of the activity that is exceeded a tenth of the time
  double margin = 0.5;            ///< kept before and after, so that the answer is seen [s]
  double least_window = 3.0;      ///< shorter ones are left out [s]
  /// Least correlation of response and command at the best lag. Below it, the loop did not answer.
  double least_correlation = 0.5;
  double greatest_lag = 1.0;  ///< [s]
};

struct RejectedWindow {
  TimeWindow window;
  std::string reason;
};

/// What of a flight is used, and why not the rest.
struct ExcitationChoice {
  std::vector<TimeWindow> windows;
  std::vector<RejectedWindow> rejected;
  TimeSeries activity;     ///< deviation of the command around each time, in its unit
  double threshold = 0.0;  ///< of the activity
};

/// Finds the windows in which the command is active and the response follows it at all. Clean record.
ExcitationChoice chooseExcitation(const LoopRecord& record, const ExcitationSearchOptions& options);

/// Greatest correlation coefficient in size, with its sign, of response and command over lags 0 ..
/// greatest_lag.
double bestCorrelation(const TimeSeries& command, const TimeSeries& response, const TimeWindow& window,
                       double greatest_lag);

/// The value in force at a time; the first one before that.
double heldValue(const TimeSeries& series, double time);

}  // namespace polyfly
