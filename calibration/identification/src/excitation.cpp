#include "identification/excitation.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "polyfly_base/quantile.hpp"

namespace polyfly {
namespace {

// Time step of activity and correlation [s].
constexpr double kGrid = 0.05;
// Half width of the stretch over which the deviation of the command counts as activity [s].
constexpr double kHalfWidth = 1.0;
// Threshold as a share of the activity that is exceeded 10 % of the time.
constexpr double kThresholdShare = 0.25;
constexpr double kBusyShare = 0.9;
// Threshold as a share of the activity above which lies half of its energy. The greater threshold counts.
constexpr double kEnergyShare = 0.06;
// Margin before and after a window, so that the response is included [s].
constexpr double kMargin = 0.5;
// Gap below which two windows are joined [s].
constexpr double kJoin = 1.0;
// Activity below which the command counts as constant.
constexpr double kLeastActivity = 1e-9;

// The values held at a window's start and every kGrid after it. Counted, because a grid that is summed up
// stands still where the times are great. The window must be without far steps.
std::vector<double> onGrid(const TimeSeries& series, const TimeWindow& window) {
  const auto count = static_cast<std::size_t>((window.to - window.from) / kGrid) + 1;
  std::vector<double> values(count);
  const auto after = std::upper_bound(series.time.begin(), series.time.end(), window.from);
  auto at = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - series.time.begin() - 1));
  for (std::size_t i = 0; i < count; ++i) {
    const double time = window.from + kGrid * static_cast<double>(i);
    while (at + 1 < series.time.size() && series.time[at + 1] <= time) ++at;
    values[i] = series.value[at];
  }
  return values;
}

// Deviation of the command around each time of the grid.
std::vector<double> activityOf(const TimeSeries& command, const TimeWindow& window) {
  const std::vector<double> values = onGrid(command, window);
  const auto reach = static_cast<std::ptrdiff_t>(std::lround(kHalfWidth / kGrid));
  std::vector<double> sum(values.size() + 1, 0.0);
  std::vector<double> square(values.size() + 1, 0.0);
  std::vector<double> activity;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i] - values.front();
    sum[i + 1] = sum[i] + value;
    square[i + 1] = square[i] + value * value;
  }
  const auto size = static_cast<std::ptrdiff_t>(values.size());
  for (std::ptrdiff_t i = 0; i < size; ++i) {
    const auto from = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, i - reach));
    const auto to = static_cast<std::size_t>(std::min(size, i + reach + 1));
    const auto count = static_cast<double>(to - from);
    const double mean = (sum[to] - sum[from]) / count;
    const double variance = (square[to] - square[from]) / count - mean * mean;
    activity.push_back(std::sqrt(std::max(0.0, variance)));
  }
  return activity;
}

// Activity above which lies half of its energy. Where a short excitation is in a long hover, the quantile is that of
// the hover, this level that of the excitation.
double energyLevel(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  double energy = 0.0;
  for (const double value : values) energy += value * value;
  double below = 0.0;
  for (const double value : values) {
    below += value * value;
    if (2.0 * below >= energy) return value;
  }
  return 0.0;
}

std::vector<TimeWindow> activeWindows(const TimeWindow& all, const std::vector<double>& activity,
                                      double threshold) {
  std::vector<TimeWindow> windows;
  for (std::size_t i = 0; i < activity.size(); ++i) {
    if (activity[i] < threshold) continue;
    const double time = all.from + kGrid * static_cast<double>(i);
    const TimeWindow around = {std::max(all.from, time - kMargin), std::min(all.to, time + kMargin)};
    if (!windows.empty() && around.from <= windows.back().to + kJoin) {
      windows.back().to = around.to;
    } else {
      windows.push_back(around);
    }
  }
  return windows;
}

double correlation(const std::vector<double>& command, const std::vector<double>& response, std::size_t lag) {
  const auto count = static_cast<Eigen::Index>(response.size() - lag);
  Eigen::VectorXd one = Eigen::Map<const Eigen::VectorXd>(command.data(), count);
  Eigen::VectorXd other = Eigen::Map<const Eigen::VectorXd>(response.data() + lag, count);
  one.array() -= one.mean();
  other.array() -= other.mean();
  const double scale = one.norm() * other.norm();
  return scale > 0.0 ? one.dot(other) / scale : 0.0;
}

}  // namespace

double heldValue(const TimeSeries& series, double time) {
  const auto after = std::upper_bound(series.time.begin(), series.time.end(), time);
  const auto index = after == series.time.begin() ? 0 : after - series.time.begin() - 1;
  return series.value[static_cast<std::size_t>(index)];
}

double bestCorrelation(const TimeSeries& command, const TimeSeries& response, const TimeWindow& window,
                       double greatest_lag) {
  const std::vector<double> commanded = onGrid(command, window);
  const std::vector<double> answered = onGrid(response, window);
  const auto lags = std::min(static_cast<std::size_t>(greatest_lag / kGrid), answered.size() / 2);
  double best = 0.0;
  for (std::size_t lag = 0; lag <= lags && lag < answered.size(); ++lag) {
    const double value = correlation(commanded, answered, lag);
    if (std::abs(value) > std::abs(best)) best = value;
  }
  return best;
}

namespace {

TimeSeries within(const TimeSeries& series, const TimeWindow& window) {
  const auto from = std::lower_bound(series.time.begin(), series.time.end(), window.from);
  const auto to = std::upper_bound(from, series.time.end(), window.to);
  const auto value = series.value.begin();
  return {{from, to}, {value + (from - series.time.begin()), value + (to - series.time.begin())}};
}

}  // namespace

ExcitationChoice chooseExcitation(const LoopRecord& record) {
  ExcitationChoice choice;
  if (record.command.time.empty() || record.response.time.empty()) return choice;
  const TimeWindow all = {std::max(record.command.time.front(), record.response.time.front()),
                          record.response.time.back()};
  if (!(all.from < all.to)) return choice;
  // Pieces of the record with their activities, and all activities.
  std::vector<std::pair<TimeWindow, std::vector<double>>> pieces;
  std::vector<double> all_activity;
  choice.rejected = record.not_flight;
  for (const TimeWindow& window :
       windowsWithout(cutAtFarSteps({all}, record.response.time), record.not_flight)) {
    if (!(typicalPeriod(within(record.response, window)) <= kLongestPeriod)) {
      choice.rejected.push_back({window, "its samples are too far apart"});
      continue;
    }
    pieces.emplace_back(window, activityOf(record.command, window));
    all_activity.insert(all_activity.end(), pieces.back().second.begin(), pieces.back().second.end());
  }
  const double threshold = std::max(kThresholdShare * quantileOf(all_activity, kBusyShare),
                                    kEnergyShare * energyLevel(all_activity));
  if (threshold < kLeastActivity) return choice;
  for (const auto& [piece, activity] : pieces) {
    for (const TimeWindow& window : activeWindows(piece, activity, threshold)) {
      if (window.to - window.from < kLeastWindow) {
        choice.rejected.push_back({window, "too short"});
      } else {
        choice.windows.push_back(window);
      }
    }
  }
  return choice;
}

}  // namespace polyfly
