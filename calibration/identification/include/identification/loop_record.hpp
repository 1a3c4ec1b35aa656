#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace polyfly {

/// A scalar signal as it was logged.
struct TimeSeries {
  std::vector<double> time;   ///< [s]
  std::vector<double> value;  ///< one for each time
};

/// A stretch of time, ends included.
struct TimeWindow {
  double from = 0.0;  ///< [s]
  double to = 0.0;    ///< [s]
};

/// Command and response of one inner loop (attitude, yaw rate, thrust) in one flight, on one clock.
struct LoopRecord {
  std::string source;   ///< file it came from
  TimeSeries command;   ///< holds each value until the next time
  TimeSeries response;  ///< samples of what the loop answered
  /// Half width of the sliding mean that `response` went through (see smoothedMean); 0 if none [s]. The
  /// model's response goes through the same mean before the two are compared.
  double smoothing = 0.0;
};

/// What had to be taken out of a record before it could be used.
struct CleaningCounts {
  std::size_t not_finite = 0;    ///< samples that are NaN or infinite, in time or value
  std::size_t out_of_order = 0;  ///< samples whose time does not exceed that of the sample before
};

/// The series with finite samples of increasing time only. Throws Error when times and values differ in
/// number.
TimeSeries cleaned(const TimeSeries& series, CleaningCounts* counts);

/// Seconds between neighbouring samples, the median; 0 if there are fewer than two.
double typicalPeriod(const TimeSeries& series);

/// The part of a record that lies in one window without a gap. What the model is compared on.
struct LoopSegment {
  std::vector<double> time;      ///< of the response [s], increasing
  std::vector<double> response;  ///< one for each time
  /// The command before and during the segment: the first entry is in force at the segment's start even after
  /// the greatest delay, unless the record begins later.
  TimeSeries command;
  double smoothing = 0.0;  ///< of the record [s]

  double duration() const { return time.back() - time.front(); }
};

/// A pause between samples above which a segment ends: `gap_periods` typical periods, at least 0.2 s.
constexpr double kGapPeriods = 6.0;

/// Cuts a clean record into segments: one for each window, split where the response pauses, without parts of
/// fewer than `least_samples`. `reach` is how far back the command is kept [s].
std::vector<LoopSegment> cutSegments(const LoopRecord& record, const std::vector<TimeWindow>& windows,
                                     double reach, std::size_t least_samples = 20);

/// Sliding mean over [t - half_width, t + half_width] of a quantity whose integral over time is `integral`:
/// the slope of the straight line fitted to the integral. With half_width 0 the difference quotient of the
/// neighbours. Where fewer than three samples are in reach the result is that of the three nearest. All sizes
/// equal, at least 3.
std::vector<double> smoothedMean(const std::vector<double>& time, const std::vector<double>& integral,
                                 double half_width);

/// Trapezoidal integral over time, 0 at the first sample.
std::vector<double> cumulativeIntegral(const std::vector<double>& time, const std::vector<double>& value);

}  // namespace polyfly
