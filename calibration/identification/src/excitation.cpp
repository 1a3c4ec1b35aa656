#include "identification/excitation.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace polyfly {
namespace {

constexpr double kGrid = 0.05;           // of activity and correlation [s]
constexpr double kBusyShare = 0.9;       // quantile of the activity that sets the threshold
constexpr double kJoin = 1.0;            // windows closer than this are one [s]
constexpr double kPiece = 4.0;           // of a window that is judged by itself [s]
constexpr double kLeastActivity = 1e-9;  // below, the command is constant

std::vector<double> onGrid(const TimeSeries& series, const TimeWindow& window) {
  std::vector<double> values;
  std::size_t at = 0;
  for (double time = window.from; time <= window.to; time += kGrid) {
    while (at + 1 < series.time.size() && series.time[at + 1] <= time) ++at;
    values.push_back(series.value[at]);
  }
  return values;
}

TimeSeries activityOf(const TimeSeries& command, const TimeWindow& window, double half_width) {
  const std::vector<double> values = onGrid(command, window);
  const auto reach = static_cast<std::ptrdiff_t>(std::lround(half_width / kGrid));
  std::vector<double> sum(values.size() + 1, 0.0);
  std::vector<double> square(values.size() + 1, 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i] - values.front();
    sum[i + 1] = sum[i] + value;
    square[i + 1] = square[i] + value * value;
  }
  TimeSeries activity;
  const auto size = static_cast<std::ptrdiff_t>(values.size());
  for (std::ptrdiff_t i = 0; i < size; ++i) {
    const auto from = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, i - reach));
    const auto to = static_cast<std::size_t>(std::min(size, i + reach + 1));
    const auto count = static_cast<double>(to - from);
    const double mean = (sum[to] - sum[from]) / count;
    const double variance = (square[to] - square[from]) / count - mean * mean;
    activity.time.push_back(window.from + kGrid * static_cast<double>(i));
    activity.value.push_back(std::sqrt(std::max(0.0, variance)));
  }
  return activity;
}

double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::vector<TimeWindow> activeWindows(const TimeSeries& activity, double threshold, double margin,
                                      const TimeWindow& all) {
  std::vector<TimeWindow> windows;
  for (std::size_t i = 0; i < activity.time.size(); ++i) {
    if (activity.value[i] < threshold) continue;
    const TimeWindow around = {std::max(all.from, activity.time[i] - margin),
                               std::min(all.to, activity.time[i] + margin)};
    if (!windows.empty() && around.from <= windows.back().to + kJoin) {
      windows.back().to = around.to;
    } else {
      windows.push_back(around);
    }
  }
  return windows;
}

double correlation(const std::vector<double>& command, const std::vector<double>& response, std::size_t lag) {
  const std::size_t count = response.size() - lag;
  double mean_command = 0.0;
  double mean_response = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    mean_command += command[i];
    mean_response += response[i + lag];
  }
  mean_command /= static_cast<double>(count);
  mean_response /= static_cast<double>(count);
  double product = 0.0;
  double command_square = 0.0;
  double response_square = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double a = command[i] - mean_command;
    const double b = response[i + lag] - mean_response;
    product += a * b;
    command_square += a * a;
    response_square += b * b;
  }
  const double scale = std::sqrt(command_square * response_square);
  return scale > 0.0 ? product / scale : 0.0;
}

// The window in pieces of about kPiece; what lies on the ground or in another mode is told apart from the
// rest.
std::vector<TimeWindow> pieces(const TimeWindow& window) {
  const double count = std::max(1.0, std::floor((window.to - window.from) / kPiece));
  std::vector<TimeWindow> result;
  for (double i = 0.0; i < count; ++i) {
    result.push_back({window.from + (window.to - window.from) * i / count,
                      window.from + (window.to - window.from) * (i + 1.0) / count});
  }
  return result;
}

void append(const TimeWindow& piece, std::vector<TimeWindow>* windows) {
  if (!windows->empty() && windows->back().to >= piece.from) {
    windows->back().to = piece.to;
  } else {
    windows->push_back(piece);
  }
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

ExcitationChoice chooseExcitation(const LoopRecord& record, const ExcitationOptions& options) {
  ExcitationChoice choice;
  if (record.command.time.empty() || record.response.time.empty()) return choice;
  const TimeWindow all = {std::max(record.command.time.front(), record.response.time.front()),
                          record.response.time.back()};
  if (!(all.from < all.to)) return choice;
  choice.activity = activityOf(record.command, all, options.half_width);
  choice.threshold = options.threshold_share * quantile(choice.activity.value, kBusyShare);
  if (choice.threshold < kLeastActivity) return choice;
  for (const TimeWindow& window : activeWindows(choice.activity, choice.threshold, options.margin, all)) {
    if (window.to - window.from < options.least_window) {
      choice.rejected.push_back({window, "too short"});
      continue;
    }
    std::vector<TimeWindow> unanswered;
    for (const TimeWindow& piece : pieces(window)) {
      const double follows = bestCorrelation(record.command, record.response, piece, options.greatest_lag);
      append(piece, std::abs(follows) < options.least_correlation ? &unanswered : &choice.windows);
    }
    for (const TimeWindow& piece : unanswered) {
      choice.rejected.push_back({piece, "the response does not follow the command"});
    }
  }
  return choice;
}

}  // namespace polyfly
