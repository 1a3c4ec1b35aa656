#include "command_quantum.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace polyfly {
namespace {

// Least number of levels. With fewer levels, a common divisor is no sign of rounding.
constexpr std::size_t kLeastLevels = 6;
// Least range in steps. With a smaller range, a common divisor is no sign of rounding.
constexpr double kLeastSteps = 30.0;
// Greatest range in steps. Beyond it, rounding does not matter.
constexpr double kMostSteps = 1e5;

// Of Euclid, for numbers known to `tolerance`.
double commonDivisor(double one, double other, double tolerance) {
  while (other > tolerance) {
    double rest = std::fmod(one, other);
    if (other - rest <= tolerance) rest = 0.0;
    one = other;
    other = rest;
  }
  return one;
}

}  // namespace

double commandQuantum(const std::vector<LoopSegment>& segments) {
  std::set<double> levels;
  for (const LoopSegment& segment : segments) {
    levels.insert(segment.command.value.begin(), segment.command.value.end());
  }
  if (levels.size() < kLeastLevels) return 0.0;
  const double range = *levels.rbegin() - *levels.begin();
  const double tolerance = range / kMostSteps;
  double quantum = range;
  for (auto level = std::next(levels.begin()); level != levels.end() && quantum > tolerance; ++level) {
    const double step = *level - *std::prev(level);
    if (step > tolerance) quantum = commonDivisor(quantum, step, tolerance);
  }
  return quantum > tolerance && range >= kLeastSteps * quantum ? quantum : 0.0;
}

double gainVarianceOfRounding(const std::vector<LoopSegment>& segments, double quantum) {
  if (quantum <= 0.0) return 0.0;
  std::map<double, double> held;  // seconds by level
  double total = 0.0;
  double mean = 0.0;
  for (const LoopSegment& segment : segments) {
    const TimeSeries& command = segment.command;
    for (std::size_t i = 0; i + 1 < command.time.size(); ++i) {
      const double seconds = command.time[i + 1] - command.time[i];
      held[command.value[i]] += seconds;
      mean += seconds * command.value[i];
      total += seconds;
    }
  }
  if (total <= 0.0) return 0.0;
  mean /= total;
  double energy = 0.0;
  double error = 0.0;
  for (const auto& [level, seconds] : held) {
    const double away = level - mean;
    energy += seconds * away * away;
    error += seconds * away * seconds * away;
  }
  return energy > 0.0 ? quantum * quantum / 12.0 * error / (energy * energy) : 0.0;
}

}  // namespace polyfly
