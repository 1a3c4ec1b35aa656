#include "identification/greatest_rate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "identification/excitation.hpp"
#include "identification/random_effects.hpp"

namespace polyfly {
namespace {

// Half widths of the stretch over which a rate is measured, in the order in which they are tried: the narrow one is for fast
// loops, and noisier [s].
constexpr double kHalfStretches[] = {0.3, 0.12};
// Share of a move's greatest rate from which on it counts as moving.
constexpr double kMoving = 0.5;
// Greatest deviation from a rate that counts as the same, as a share.
constexpr double kSameRate = 0.1;
// Least share of the time of moving at one rate.
constexpr double kSteadyShare = 0.5;
// Least time at one rate [s]. Not less than the stretch, over which a step that is shorter has one mean rate.
constexpr double kLeastSteady = 0.3;
// Greatest change of the command while the response moves at one rate, as a share of the response's.
constexpr double kResting = 0.5;
constexpr std::size_t kLeastMoves = 3;
// Least change of the response in a move, as a share of its range.
constexpr double kLeastChange = 0.1;
// Share of the fastest move's rate from which on a move is at the limit too.
constexpr double kNearFastest = 0.8;
// Share of the samples that may be faster than what counts as the fastest.
constexpr double kFastShare = 0.01;
// Ratio of the fastest rate to the limit above which it is no limit.
constexpr double kFasterElsewhere = 1.15;

/// Indices [first, last) of samples.
struct SampleRun {
  std::size_t first = 0;
  std::size_t last = 0;
};

double durationOf(const LoopSegment& segment, const SampleRun& run) {
  return run.last > run.first ? segment.time[run.last - 1] - segment.time[run.first] : 0.0;
}

/// The longest run of samples between `first` and `last` with a property.
template <class Holds>
SampleRun longestRun(const LoopSegment& segment, const SampleRun& within, Holds holds) {
  SampleRun longest{within.first, within.first};
  for (std::size_t i = within.first; i < within.last;) {
    std::size_t end = i;
    while (end < within.last && holds(end)) ++end;
    if (durationOf(segment, {i, end}) > durationOf(segment, longest)) longest = {i, end};
    i = end + 1;
  }
  return longest;
}

double commandRange(const LoopSegment& segment, const TimeWindow& window) {
  double least = heldValue(segment.command, window.from);
  double greatest = least;
  for (std::size_t i = 0; i < segment.command.time.size(); ++i) {
    if (segment.command.time[i] < window.from || segment.command.time[i] > window.to) continue;
    least = std::min(least, segment.command.value[i]);
    greatest = std::max(greatest, segment.command.value[i]);
  }
  return greatest - least;
}

/// The steady part of one move in one direction, if it has one.
void addSteady(const LoopSegment& segment, const std::vector<double>& rates, const SampleRun& move,
               double least_steady, std::vector<SteadyMove>* moves) {
  double greatest = 0.0;
  for (std::size_t i = move.first; i < move.last; ++i) greatest = std::max(greatest, std::abs(rates[i]));
  const SampleRun moving =
      longestRun(segment, move, [&](std::size_t i) { return std::abs(rates[i]) >= kMoving * greatest; });
  if (durationOf(segment, moving) < least_steady) return;
  std::vector<double> sorted;
  for (std::size_t i = moving.first; i < moving.last; ++i) sorted.push_back(std::abs(rates[i]));
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double level = *middle;
  const SampleRun steady = longestRun(segment, moving, [&](std::size_t i) {
    return std::abs(std::abs(rates[i]) - level) <= kSameRate * level;
  });
  const double duration = durationOf(segment, steady);
  if (duration < least_steady || duration < kSteadyShare * durationOf(segment, moving)) return;
  const TimeWindow window{segment.time[steady.first], segment.time[steady.last - 1]};
  const double change = std::abs(segment.response[steady.last - 1] - segment.response[steady.first]);
  if (commandRange(segment, window) > kResting * change) return;
  double sum = 0.0;
  for (std::size_t i = steady.first; i < steady.last; ++i) sum += std::abs(rates[i]);
  moves->push_back({window, sum / static_cast<double>(steady.last - steady.first)});
}

void addMoves(const LoopSegment& segment, const std::vector<double>& rates, double half_stretch,
              std::vector<SteadyMove>* moves) {
  const double least_steady = std::max(kLeastSteady, 2.0 * half_stretch);
  for (std::size_t i = 0; i < rates.size();) {
    std::size_t end = i + 1;
    while (end < rates.size() && (rates[end] > 0.0) == (rates[i] > 0.0)) ++end;
    addSteady(segment, rates, {i, end}, least_steady, moves);
    i = end;
  }
}

double exceededBy(std::vector<double> values, double share) {
  const auto place = static_cast<std::ptrdiff_t>((1.0 - share) * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

std::string rateReason(const char* format, double one, double other) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, one, other);
  return buffer;
}

LoopRates ratesOver(const std::vector<LoopSegment>& segments, double half_stretch) {
  LoopRates result;
  result.half_stretch = half_stretch;
  std::vector<double> sizes;
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  for (const LoopSegment& segment : segments) {
    if (segment.time.size() < 3) continue;
    const double half_width = std::max(half_stretch, segment.smoothing);
    const std::vector<double> rates = smoothedMean(segment.time, segment.response, half_width);
    addMoves(segment, rates, half_width, &result.moves);
    for (const double rate : rates) sizes.push_back(std::abs(rate));
    const auto ends = std::minmax_element(segment.response.begin(), segment.response.end());
    least = std::min(least, *ends.first);
    greatest = std::max(greatest, *ends.second);
  }
  if (!sizes.empty()) result.fastest = exceededBy(std::move(sizes), kFastShare);
  const auto is_small = [&](const SteadyMove& move) {
    return move.rate * (move.window.to - move.window.from) < kLeastChange * (greatest - least);
  };
  result.moves.erase(std::remove_if(result.moves.begin(), result.moves.end(), is_small), result.moves.end());
  return result;
}

}  // namespace

std::vector<LoopRates> loopRates(const std::vector<std::vector<LoopSegment>>& flights) {
  std::vector<LoopRates> widest;
  for (const double half_stretch : kHalfStretches) {
    std::vector<LoopRates> rates;
    for (const std::vector<LoopSegment>& segments : flights)
      rates.push_back(ratesOver(segments, half_stretch));
    if (greatestRate(rates).supported()) return rates;
    if (widest.empty()) widest = std::move(rates);
  }
  return widest;
}

std::vector<TimeWindow> stretchesAt(const GreatestRate& rate, const std::vector<LoopSegment>& segments) {
  std::vector<TimeWindow> result;
  for (const LoopSegment& segment : segments) {
    if (segment.time.size() < 3) continue;
    const double half_width = std::max(rate.half_stretch, segment.smoothing);
    const std::vector<double> rates = smoothedMean(segment.time, segment.response, half_width);
    for (std::size_t i = 0; i < rates.size(); ++i) {
      if (std::abs(rates[i]) < (1.0 - kSameRate) * rate.value) continue;
      const TimeWindow around{segment.time[i] - half_width, segment.time[i] + half_width};
      if (result.empty() || around.from > result.back().to)
        result.push_back(around);
      else
        result.back().to = around.to;
    }
  }
  return result;
}

GreatestRate greatestRate(const std::vector<LoopRates>& flights) {
  GreatestRate result;
  double limit = 0.0, fastest = 0.0;
  if (!flights.empty()) result.half_stretch = flights.front().half_stretch;
  for (const LoopRates& flight : flights) {
    fastest = std::max(fastest, flight.fastest);
    for (const SteadyMove& move : flight.moves) limit = std::max(limit, move.rate);
  }
  for (const LoopRates& flight : flights)
    for (const SteadyMove& move : flight.moves)
      if (move.rate >= kNearFastest * limit) result.moves.push_back(move);
  const auto count = static_cast<double>(result.moves.size());
  if (result.moves.size() < kLeastMoves) {
    result.reasons.push_back(rateReason(
        "%.0f moves at one rate while the command rests, of %.0f that are needed: fly large steps, and "
        "hold them.",
        count, static_cast<double>(kLeastMoves)));
    return result;
  }
  for (const SteadyMove& move : result.moves) result.value += move.rate / count;
  double squares = 0.0, farthest = 0.0;
  for (const SteadyMove& move : result.moves) {
    const double deviation = std::abs(move.rate - result.value);
    squares += deviation * deviation;
    farthest = std::max(farthest, deviation);
  }
  result.half_width =
      studentFactor(static_cast<int>(result.moves.size()) - 1) * std::sqrt(squares / (count - 1.0) / count);
  if (farthest > kSameRate * result.value) {
    result.reasons.push_back(
        rateReason("The moves have no rate in common: from the mean of %.3g one differs by %.3g.",
                   result.value, farthest));
  }
  if (fastest > kFasterElsewhere * result.value) {
    result.reasons.push_back(
        rateReason("The response moves at up to %.3g elsewhere, faster than at this rate of %.3g.", fastest,
                   result.value));
  }
  return result;
}

}  // namespace polyfly
