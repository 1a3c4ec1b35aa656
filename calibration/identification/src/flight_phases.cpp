#include "identification/flight_phases.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "polyfly_base/quantile.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

// Step of the grid on which the signs of an upset or of the ground are looked for [s].
constexpr double kPhaseStep = 0.05;
// Greatest period of the attitude, which sets the grid, and pause from which on a measurement is unknown [s].
constexpr double kSlowest = 0.5;
constexpr double kStale = 1.0;
// Steps over which what was commanded before is looked at, and in which the vehicle must stand.
constexpr std::size_t kCommandSteps = 30;
constexpr std::size_t kStandSteps = 40;
// Tilt that is no upset in any case, tilt beyond a command from which on it is one, and where no command tells [rad].
constexpr double kTiltAllowed = 1.0;
constexpr double kTiltBeyond = 0.7;
constexpr double kTiltUncommanded = 1.5;
// Range of roll and pitch up to which the attitude rests, with a throttle and without one [rad].
constexpr double kRestAngle = 0.03;
constexpr double kDeepRestAngle = 0.01;
// Speed up to which the vehicle stands, and from which on it moves [m/s].
constexpr double kSlow = 0.5;
constexpr double kFast = 2.0;
// Throttle at its least, as shares of what is rarely exceeded and of its range. It must vary by the factor.
constexpr double kRareShare = 0.98;
constexpr double kIdleShare = 0.3;
constexpr double kIdleRange = 0.1;
constexpr double kThrottleVaries = 1.5;
// What an upset and the ground take before and after them [s].
constexpr double kPhaseMargin = 0.5;
constexpr double kUpsetAfter = 1.5;
// Flight between two stretches, or to the end, that is too short to count [s].
constexpr double kLeastFlight = 4.0;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Values at the times of a grid. Empty where the signal is not there; NaN where it pauses.
using Values = std::vector<double>;

// One piece of a flight.
struct Grid {
  // First time [s].
  double from = 0.0;
  std::size_t size = 0;
  Values roll, pitch, speed, roll_cmd, pitch_cmd, throttle;
  double time(std::size_t i) const { return from + kPhaseStep * static_cast<double>(i); }
};

Values valuesOn(const Grid& grid, const TimeSeries& series, double stale) {
  if (series.time.empty()) return {};
  Values values(grid.size, kUnknown);
  std::size_t next = 0;
  for (std::size_t i = 0; i < grid.size; ++i) {
    while (next < series.time.size() && series.time[next] <= grid.time(i)) ++next;
    if (next > 0 && grid.time(i) - series.time[next - 1] <= stale) values[i] = series.value[next - 1];
  }
  return values;
}

// Size of the velocity, over ground where it is not known in space.
Values speedOf(const Grid& grid, const FlightSignals& signals) {
  const std::vector<std::vector<const char*>> choices = {{"vx", "vy", "vz"}, {"vn", "ve"}};
  for (const std::vector<const char*>& names : choices) {
    Values speed(grid.size, 0.0);
    for (const char* name : names) {
      const Values part = valuesOn(grid, cleanSignal(signals, name), kStale);
      if (part.empty()) speed.clear();
      for (std::size_t i = 0; i < speed.size(); ++i) speed[i] = std::hypot(speed[i], part[i]);
    }
    if (!speed.empty()) return speed;
  }
  return {};
}

// The pieces between far steps of the attitude; none where it is not sampled often enough.
std::vector<Grid> gridsOf(const FlightSignals& signals) {
  const TimeSeries roll = cleanSignal(signals, "roll");
  std::vector<Grid> grids;
  if (roll.time.size() < 2 || !(typicalPeriod(roll, kFarStep) <= kSlowest)) return grids;
  for (const TimeWindow& piece : cutAtFarSteps({{roll.time.front(), roll.time.back()}}, roll.time)) {
    Grid grid;
    grid.from = piece.from;
    grid.size = static_cast<std::size_t>((piece.to - piece.from) / kPhaseStep) + 1;
    const auto held = [&](const char* name, double stale) {
      return valuesOn(grid, cleanSignal(signals, name), stale);
    };
    grid.roll = held("roll", kStale);
    grid.pitch = held("pitch", kStale);
    grid.roll_cmd = held("roll_cmd", kFarStep);
    grid.pitch_cmd = held("pitch_cmd", kFarStep);
    grid.throttle = held("thrust_cmd", kFarStep);
    grid.speed = speedOf(grid, signals);
    grids.push_back(std::move(grid));
  }
  return grids;
}

// Least and greatest value of [from, to]; not known where one of them is not.
struct Extent {
  double least = kUnknown;
  double greatest = kUnknown;
  double range() const { return greatest - least; }
};

Extent extentOf(const Values& values, std::size_t from, std::size_t to) {
  Extent extent;
  for (std::size_t i = from; i <= to && !values.empty(); ++i) {
    if (!std::isfinite(values[i])) return {};
    extent = {std::fmin(extent.least, values[i]), std::fmax(extent.greatest, values[i])};
  }
  return extent;
}

// Why each step of a grid is no flight; empty: it is.
using Reasons = std::vector<std::string>;

// Of steps [first, last] and what they take before and after.
void mark(std::size_t first, std::size_t last, double after, const char* reason, Reasons* reasons) {
  const auto steps = [](double seconds) {
    return static_cast<std::size_t>(std::lround(seconds / kPhaseStep));
  };
  const std::size_t from = first - std::min(first, steps(kPhaseMargin));
  for (std::size_t i = from; i < std::min(reasons->size(), last + steps(after)); ++i) (*reasons)[i] = reason;
}

void markUpsets(const Grid& grid, Reasons* reasons) {
  if (grid.pitch.empty()) return;
  const bool commanded = !grid.roll_cmd.empty() && !grid.pitch_cmd.empty();
  double tilt_before = 0.0;
  for (std::size_t i = 0; i < grid.size; ++i) {
    const auto recent = [i](const Values& command) {
      const Extent extent = extentOf(command, i - std::min(i, kCommandSteps), i);
      return std::fmax(0.0, std::fmax(-extent.least, extent.greatest));
    };
    const double allowed =
        commanded
            ? std::max(kTiltAllowed, kTiltBeyond + std::hypot(recent(grid.roll_cmd), recent(grid.pitch_cmd)))
            : kTiltUncommanded;
    const double tilt = std::acos(std::clamp(std::cos(grid.roll[i]) * std::cos(grid.pitch[i]), -1.0, 1.0));
    // A single sample is an outlier.
    if (tilt > allowed && tilt_before > kTiltAllowed)
      mark(i, i, kUpsetAfter, "upset, not commanded", reasons);
    tilt_before = tilt;
  }
}

// Up to which the throttle is at its least, by all pieces of a flight. NaN: it tells nothing.
double idleThrottle(const std::vector<Grid>& grids) {
  Values values;
  for (const Grid& grid : grids) {
    std::copy_if(grid.throttle.begin(), grid.throttle.end(), std::back_inserter(values),
                 [](double value) { return std::isfinite(value); });
  }
  if (values.empty()) return kUnknown;
  const double least = *std::min_element(values.begin(), values.end());
  const double most = quantileOf(std::move(values), kRareShare);
  if (least < 0.0 || most <= kThrottleVaries * least) return kUnknown;
  return std::max(kIdleShare * most, least + kIdleRange * (most - least));
}

// Whether the vehicle stands throughout [from, to]. What is not known is NaN and tells nothing.
bool standsIn(const Grid& grid, double idle, std::size_t from, std::size_t to) {
  const double speed = extentOf(grid.speed, from, to).greatest;
  const double throttle = extentOf(grid.throttle, from, to).greatest;
  if (speed > kFast || throttle > idle) return false;
  const auto rests = [&](double range) {
    return extentOf(grid.roll, from, to).range() < range && extentOf(grid.pitch, from, to).range() < range;
  };
  return throttle <= idle ? speed < kSlow || rests(kRestAngle) : speed < kSlow && rests(kDeepRestAngle);
}

void markGround(const Grid& grid, double idle, Reasons* reasons) {
  for (std::size_t from = 0; from + kStandSteps < grid.size; ++from) {
    if (standsIn(grid, idle, from, from + kStandSteps))
      mark(from, from + kStandSteps, kPhaseMargin, "on the ground", reasons);
  }
}

// The stretches of equal reasons. Flight that is too short between them belongs to the one before it.
std::vector<RejectedWindow> stretchesOf(const Grid& grid, const Reasons& reasons) {
  std::vector<RejectedWindow> found;
  for (std::size_t i = 0; i < grid.size; ++i) {
    if (reasons[i].empty()) continue;
    const double last = found.empty() ? grid.from : found.back().window.to;
    const double from = grid.time(i) - last < kLeastFlight ? last : grid.time(i);
    if (from > last || found.empty() || reasons[i] != found.back().reason)
      found.push_back({{from, from}, reasons[i]});
    found.back().window.to = grid.time(i + 1);
  }
  const double end = grid.time(grid.size);
  if (!found.empty() && end - found.back().window.to < kLeastFlight) found.back().window.to = end;
  return found;
}

}  // namespace

std::vector<RejectedWindow> findNonFlight(const FlightSignals& signals, bool on_ground) {
  const std::vector<Grid> grids = gridsOf(signals);
  const double idle = idleThrottle(grids);
  std::vector<RejectedWindow> all;
  for (const Grid& grid : grids) {
    Reasons reasons(grid.size);
    if (!on_ground) markGround(grid, idle, &reasons);
    markUpsets(grid, &reasons);
    for (RejectedWindow& one : stretchesOf(grid, reasons)) all.push_back(std::move(one));
  }
  return all;
}

std::vector<std::string> clausesOn(const std::vector<RejectedWindow>& left_out) {
  constexpr std::size_t kMostTimes = 12;
  std::vector<std::string> clauses;
  std::vector<std::string> reasons;
  for (const RejectedWindow& one : left_out) {
    if (std::find(reasons.begin(), reasons.end(), one.reason) == reasons.end()) reasons.push_back(one.reason);
  }
  for (const std::string& reason : reasons) {
    std::string times;
    std::size_t count = 0;
    for (const RejectedWindow& one : left_out) {
      if (one.reason != reason || ++count > kMostTimes) continue;
      times += sentence("%s%.1f .. %.1f", count > 1 ? ", " : "", one.window.from, one.window.to);
    }
    if (count > kMostTimes) times += " and " + std::to_string(count - kMostTimes) + " more";
    clauses.push_back(times + (count > kMostTimes ? ": " : " s: ") + reason);
  }
  return clauses;
}

std::string whyNotFlight(const std::vector<RejectedWindow>& left_out, const std::vector<TimeWindow>& given) {
  std::string why;
  if (!given.empty()) return why;
  for (const std::string& clause : clausesOn(left_out)) why += "; left out " + clause;
  return why;
}

}  // namespace polyfly
