#pragma once

#include <string>
#include <vector>

#include "identification/loop_record.hpp"

namespace polyfly {

/// Least length of a window. Shorter windows are left out [s].
constexpr double kLeastWindow = 3.0;

/// What of a flight is used, and why not the rest.
struct ExcitationChoice {
  std::vector<TimeWindow> windows;
  std::vector<RejectedWindow> rejected;
};

/// Finds the windows in which the vehicle flies and the command is active.
/// Clean record.
ExcitationChoice chooseExcitation(const LoopRecord& record);

/// Greatest correlation coefficient in size, with its sign, of response and command over lags 0 ..
/// greatest_lag.
double bestCorrelation(const TimeSeries& command, const TimeSeries& response, const TimeWindow& window,
                       double greatest_lag);

/// The value in force at a time; the first one before that.
double heldValue(const TimeSeries& series, double time);

}  // namespace polyfly
