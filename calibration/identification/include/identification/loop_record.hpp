#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
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
inline bool operator==(const TimeWindow& one, const TimeWindow& other) {
  return one.from == other.from && one.to == other.to;
}

/// A stretch of a flight that is left out.
struct RejectedWindow {
  TimeWindow window;
  std::string reason;
};

/// Command and response of one inner loop (attitude, yaw rate, thrust) in one flight, on one clock.
struct LoopRecord {
  std::string source;   ///< file it came from
  TimeSeries command;   ///< holds each value until the next time
  TimeSeries response;  ///< samples of what the loop answered
  /// Half width of the sliding mean that `response` went through (see smoothedMean); 0 if none [s]. The
  /// model's response goes through the same mean before the two are compared.
  double smoothing = 0.0;
  /// Stretches in which the vehicle does not fly (see findNonFlight), in order of time.
  std::vector<RejectedWindow> not_flight;
};

/// A step between samples, forward or back, that is far: there the clock was set, or nothing was recorded.
/// Identification looks at most 5 s back (activity 1 s, delay 3 s), and no command in flight is held for a
/// minute. So the two sides of a far step say nothing of each other, and what spans both is cut there.
constexpr double kFarStep = 60.0;  // [s]

inline bool isFarStep(double from, double to) { return !(std::abs(to - from) <= kFarStep); }

/// Two neighbouring samples that are far apart.
struct FarStep {
  double from = 0.0;  ///< time of the one [s]
  double to = 0.0;    ///< time of the next in the record, which may be earlier [s]
};

/// The far steps between finite times, in the order of the record.
std::vector<FarStep> farSteps(const std::vector<double>& time);

/// From the first to the last of the times, which are finite, without the far steps between [s].
double durationOf(const std::vector<double>& time);

/// When and by how much: "after 12.5 s the times jump by 3600 s". Of many steps the first ones and the number
/// of the others.
std::vector<std::string> sentencesOn(const std::vector<FarStep>& steps);

/// The end of a sentence on a series of which nothing can be used: what may be wrong with its times. They jump, or
/// are not in seconds. Empty if neither.
std::string whyUnusable(const TimeSeries& series);

/// What the far steps of a clean series leave of the windows; nothing shorter than two samples.
std::vector<TimeWindow> cutAtFarSteps(const std::vector<TimeWindow>& windows,
                                      const std::vector<double>& time);

/// The series without what lies in the windows.
TimeSeries without(const TimeSeries& series, const std::vector<TimeWindow>& windows);

/// What is left of the windows without the others, in order of time.
std::vector<TimeWindow> windowsWithout(const std::vector<TimeWindow>& windows,
                                       const std::vector<RejectedWindow>& others);

/// The series with finite samples of increasing time only. Where its times jump far, the pieces between are put in
/// the order of their times first. So a clock that was set back costs no more than what overlaps. Throws Error when
/// times and values differ in number.
TimeSeries cleaned(const TimeSeries& series);

/// The straight line between neighbouring samples; the first and last value beyond them. Not empty.
double interpolated(const TimeSeries& series, double time);

/// Seconds between neighbouring samples, the median of those up to `longest`; 0 if there are none.
double typicalPeriod(const TimeSeries& series, double longest = std::numeric_limits<double>::infinity());

/// The part of a record that lies in one window without a gap. What the model is compared on.
struct LoopSegment {
  /// Times of the response, increasing [s].
  std::vector<double> time;
  /// Response, one value for each time.
  std::vector<double> response;
  /// The command before and during the segment. The first entry is in force at the segment's start even after the
  /// greatest delay, unless the record begins later.
  TimeSeries command;
  /// Smoothing of the record, see LoopRecord [s].
  double smoothing = 0.0;

  double duration() const { return time.back() - time.front(); }
};

/// A pause between samples above which a segment ends: `gap_periods` typical periods, at least 0.2 s.
constexpr double kGapPeriods = 6.0;

/// Samples that are typically farther apart tell nothing of a flight: activity is looked for within 2 s. Such
/// times are not in seconds.
constexpr double kLongestPeriod = 2.0;  // [s]

/// Cuts a clean record into segments: one for each window, split where the response pauses, without parts of
/// fewer than `least_samples`. `reach` is how far back the command is kept [s]. Samples that are farther
/// apart than kLongestPeriod count as a pause.
std::vector<LoopSegment> cutSegments(const LoopRecord& record, const std::vector<TimeWindow>& windows,
                                     double reach, std::size_t least_samples = 20);

/// Sliding mean over [t - half_width, t + half_width] of a quantity whose integral over time is `integral`. It is the
/// slope of the straight line fitted to the integral. With half_width 0 the difference quotient of the neighbours.
/// Where fewer than three samples are in reach the result is that of the three nearest. All sizes equal, at least 3.
std::vector<double> smoothedMean(const std::vector<double>& time, const std::vector<double>& integral,
                                 double half_width);

/// Trapezoidal integral over time, 0 at the first sample. Far steps add nothing.
std::vector<double> cumulativeIntegral(const std::vector<double>& time, const std::vector<double>& value);

}  // namespace polyfly
