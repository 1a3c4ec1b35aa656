#include "identification/loop_record.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "polyfly_base/error.hpp"
#include "polyfly_base/quantile.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

constexpr double kLeastGap = 0.2;          // [s]
constexpr std::size_t kLeastForSlope = 3;  // samples that a slope is fitted to
constexpr std::size_t kMostTold = 5;       // far steps that get a sentence of their own

// Samples [first, last) of the response that one window and the pauses leave together.
struct Stretch {
  std::size_t first = 0;
  std::size_t last = 0;
};

std::vector<Stretch> stretches(const TimeSeries& response, const TimeWindow& window, double gap) {
  std::vector<Stretch> found;
  const auto begin = std::lower_bound(response.time.begin(), response.time.end(), window.from);
  const auto end = std::upper_bound(begin, response.time.end(), window.to);
  auto start = begin;
  for (auto at = begin; at != end; ++at) {
    if (at + 1 == end || at[1] - at[0] > gap) {
      found.push_back({static_cast<std::size_t>(start - response.time.begin()),
                       static_cast<std::size_t>(at + 1 - response.time.begin())});
      start = at + 1;
    }
  }
  return found;
}

LoopSegment segmentOf(const LoopRecord& record, const Stretch& stretch, double reach) {
  LoopSegment segment;
  const auto first = static_cast<std::ptrdiff_t>(stretch.first);
  const auto last = static_cast<std::ptrdiff_t>(stretch.last);
  segment.time.assign(record.response.time.begin() + first, record.response.time.begin() + last);
  segment.response.assign(record.response.value.begin() + first, record.response.value.begin() + last);
  segment.smoothing = record.smoothing;
  const std::vector<double>& times = record.command.time;
  auto from = std::upper_bound(times.begin(), times.end(), segment.time.front() - reach);
  if (from != times.begin()) --from;
  const auto to = std::upper_bound(from, times.end(), segment.time.back() + reach);
  segment.command.time.assign(from, to);
  segment.command.value.assign(record.command.value.begin() + (from - times.begin()),
                               record.command.value.begin() + (to - times.begin()));
  return segment;
}

// Slope of the straight line through the samples [first, last).
double slope(const std::vector<double>& time, const std::vector<double>& value, std::size_t first,
             std::size_t last) {
  double mean_time = 0.0;
  double mean_value = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    mean_time += time[i];
    mean_value += value[i];
  }
  const auto count = static_cast<double>(last - first);
  mean_time /= count;
  mean_value /= count;
  double spread = 0.0;
  double product = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    spread += (time[i] - mean_time) * (time[i] - mean_time);
    product += (time[i] - mean_time) * (value[i] - mean_value);
  }
  return product / spread;
}

// The finite samples as pieces without far steps, the one that begins first before the others.
std::vector<TimeSeries> piecesInOrder(const TimeSeries& series) {
  std::vector<TimeSeries> pieces;
  for (std::size_t i = 0; i < series.time.size(); ++i) {
    if (!std::isfinite(series.time[i]) || !std::isfinite(series.value[i])) continue;
    if (pieces.empty() || isFarStep(pieces.back().time.back(), series.time[i])) pieces.emplace_back();
    pieces.back().time.push_back(series.time[i]);
    pieces.back().value.push_back(series.value[i]);
  }
  std::stable_sort(pieces.begin(), pieces.end(), [](const TimeSeries& one, const TimeSeries& other) {
    return one.time.front() < other.time.front();
  });
  return pieces;
}

}  // namespace

std::vector<FarStep> farSteps(const std::vector<double>& time) {
  std::vector<FarStep> steps;
  const double* before = nullptr;
  for (const double& one : time) {
    if (!std::isfinite(one)) continue;
    if (before != nullptr && isFarStep(*before, one)) steps.push_back({*before, one});
    before = &one;
  }
  return steps;
}

double durationOf(const std::vector<double>& time) {
  if (time.empty()) return 0.0;
  double duration = time.back() - time.front();
  for (const FarStep& step : farSteps(time)) duration -= step.to - step.from;
  return duration;
}

std::vector<std::string> sentencesOn(const std::vector<FarStep>& steps) {
  std::vector<std::string> sentences;
  for (std::size_t i = 0; i < std::min(steps.size(), kMostTold); ++i) {
    sentences.push_back(
        sentence("after %.12g s the times jump by %.6g s", steps[i].from, steps[i].to - steps[i].from));
  }
  if (steps.size() > kMostTold) {
    sentences.push_back("the times jump " + std::to_string(steps.size() - kMostTold) + " times more");
  }
  return sentences;
}

std::string whyUnusable(const TimeSeries& series) {
  const double period = typicalPeriod(cleaned(series));
  if (!(period <= kLongestPeriod)) {
    return sentence(
        "; its samples are %.6g s apart: are the times in seconds? --signal time=COLUMN:ms says so of a CSV",
        period);
  }
  std::string why;
  for (const std::string& sentence : sentencesOn(farSteps(series.time))) why += "; " + sentence;
  return why;
}

std::vector<TimeWindow> cutAtFarSteps(const std::vector<TimeWindow>& windows,
                                      const std::vector<double>& time) {
  const std::vector<FarStep> steps = farSteps(time);
  std::vector<TimeWindow> left;
  for (TimeWindow rest : windows) {
    for (const FarStep& step : steps) {
      if (step.to <= rest.from) continue;
      if (step.from >= rest.to) break;
      if (rest.from < step.from) left.push_back({rest.from, step.from});
      rest.from = step.to;
    }
    if (rest.from < rest.to) left.push_back(rest);
  }
  return left;
}

TimeSeries without(const TimeSeries& series, const std::vector<TimeWindow>& windows) {
  TimeSeries result;
  for (std::size_t i = 0; i < series.time.size(); ++i) {
    const double time = series.time[i];
    const bool left_out = std::any_of(windows.begin(), windows.end(), [time](const TimeWindow& window) {
      return window.from <= time && time < window.to;
    });
    if (left_out) continue;
    result.time.push_back(time);
    result.value.push_back(series.value[i]);
  }
  return result;
}

std::vector<TimeWindow> windowsWithout(const std::vector<TimeWindow>& windows,
                                       const std::vector<RejectedWindow>& others) {
  std::vector<TimeWindow> left = windows;
  for (const RejectedWindow& other : others) {
    std::vector<TimeWindow> rest;
    for (const TimeWindow& window : left) {
      if (other.window.to <= window.from || other.window.from >= window.to) {
        rest.push_back(window);
        continue;
      }
      if (window.from < other.window.from) rest.push_back({window.from, other.window.from});
      if (other.window.to < window.to) rest.push_back({other.window.to, window.to});
    }
    left = rest;
  }
  return left;
}

TimeSeries cleaned(const TimeSeries& series) {
  if (series.time.size() != series.value.size())
    throw Error("time series: as many times as values are needed");
  TimeSeries clean;
  for (const TimeSeries& piece : piecesInOrder(series)) {
    for (std::size_t i = 0; i < piece.time.size(); ++i) {
      if (!clean.time.empty() && piece.time[i] <= clean.time.back()) continue;
      clean.time.push_back(piece.time[i]);
      clean.value.push_back(piece.value[i]);
    }
  }
  return clean;
}

double interpolated(const TimeSeries& series, double time) {
  const auto after = std::upper_bound(series.time.begin(), series.time.end(), time);
  if (after == series.time.begin()) return series.value.front();
  if (after == series.time.end()) return series.value.back();
  const auto i = static_cast<std::size_t>(after - series.time.begin());
  const double share = (time - series.time[i - 1]) / (series.time[i] - series.time[i - 1]);
  return series.value[i - 1] + share * (series.value[i] - series.value[i - 1]);
}

double typicalPeriod(const TimeSeries& series, double longest) {
  std::vector<double> periods;
  for (std::size_t i = 1; i < series.time.size(); ++i) {
    const double period = series.time[i] - series.time[i - 1];
    if (period <= longest) periods.push_back(period);
  }
  return quantileOf(std::move(periods));
}

std::vector<LoopSegment> cutSegments(const LoopRecord& record, const std::vector<TimeWindow>& windows,
                                     double reach, std::size_t least_samples) {
  const double gap = std::max(kLeastGap, kGapPeriods * typicalPeriod(record.response, kLongestPeriod));
  std::vector<LoopSegment> segments;
  if (record.command.time.empty()) return segments;
  for (const TimeWindow& window : windows) {
    // Before its first entry the command is not known.
    const TimeWindow known = {std::max(window.from, record.command.time.front()), window.to};
    for (const Stretch& stretch : stretches(record.response, known, gap)) {
      if (stretch.last - stretch.first < std::max(least_samples, kLeastForSlope)) continue;
      segments.push_back(segmentOf(record, stretch, reach));
    }
  }
  return segments;
}

std::vector<double> smoothedMean(const std::vector<double>& time, const std::vector<double>& integral,
                                 double half_width) {
  const std::size_t count = time.size();
  std::vector<double> mean(count);
  std::size_t first = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    while (time[first] < time[i] - half_width) ++first;
    while (last < count && time[last] <= time[i] + half_width) ++last;
    std::size_t from = first;
    std::size_t to = last;
    if (to - from < kLeastForSlope) {
      from = std::min(i == 0 ? 0 : i - 1, count - kLeastForSlope);
      to = from + kLeastForSlope;
    }
    mean[i] = slope(time, integral, from, to);
  }
  return mean;
}

std::vector<double> cumulativeIntegral(const std::vector<double>& time, const std::vector<double>& value) {
  std::vector<double> integral(time.size(), 0.0);
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double step = isFarStep(time[i - 1], time[i]) ? 0.0 : time[i] - time[i - 1];
    integral[i] = integral[i - 1] + 0.5 * (value[i] + value[i - 1]) * step;
  }
  return integral;
}

}  // namespace polyfly
