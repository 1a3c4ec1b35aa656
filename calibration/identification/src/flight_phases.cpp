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
// Greatest period of the signal that sets the grid, and pause from which on a measurement is unknown [s].
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
// Speed up to which the vehicle may stand, and from which on it moves [m/s].
constexpr double kSlow = 0.5;
constexpr double kFast = 2.0;
// Share of its values that a signal rarely exceeds.
constexpr double kRareShare = 0.98;
// Throttle at its least, as shares of what is rarely exceeded and of its range. It must vary by the factor.
constexpr double kIdleShare = 0.3;
constexpr double kIdleRange = 0.1;
constexpr double kThrottleVaries = 1.5;
// Share of the airspeed that is rarely exceeded up to which a fixed wing does not fly, and the least of it [m/s].
constexpr double kStallShare = 0.35;
constexpr double kLeastCruise = 6.0;
// Shares of the range of height in which the vehicle may stand and surely flies, and the least range [m].
constexpr double kLowShare = 0.15;
constexpr double kHighShare = 0.5;
constexpr double kLeastHeightRange = 1.0;
// Upsets, and stretches on the ground, that are closer are one [s].
constexpr double kUpsetJoin = 3.0;
constexpr double kGroundJoin = 4.0;
// What an upset takes before and after it, and landing and take-off [s].
constexpr double kUpsetBefore = 0.5;
constexpr double kUpsetAfter = 1.5;
constexpr double kGroundMargin = 0.5;
// A vehicle that rests this soon after an upset lies on the ground [s].
constexpr double kLiesWithin = 3.0;
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
  Values roll, pitch, speed, airspeed, height, roll_cmd, pitch_cmd, throttle;
  double time(std::size_t i) const { return from + kPhaseStep * static_cast<double>(i); }
};

// Indices [first, last] of a grid.
struct Span {
  std::size_t first = 0;
  std::size_t last = 0;
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

Grid gridOf(const FlightSignals& signals, const TimeWindow& window) {
  Grid grid;
  grid.from = window.from;
  grid.size = static_cast<std::size_t>((window.to - window.from) / kPhaseStep) + 1;
  const auto held = [&](const char* name, double stale) {
    return valuesOn(grid, cleanSignal(signals, name), stale);
  };
  grid.roll = held("roll", kStale);
  grid.pitch = held("pitch", kStale);
  grid.airspeed = held("airspeed", kStale);
  grid.height = held("height", kStale);
  grid.roll_cmd = held("roll_cmd", kFarStep);
  grid.pitch_cmd = held("pitch_cmd", kFarStep);
  grid.throttle = held("thrust_cmd", kFarStep);
  grid.speed = speedOf(grid, signals);
  return grid;
}

// The pieces between far steps of the signal that is sampled throughout; none where nothing is sampled often enough.
std::vector<Grid> gridsOf(const FlightSignals& signals) {
  TimeSeries base;
  for (const char* name : {"roll", "vx", "vn"}) {
    base = cleanSignal(signals, name);
    if (base.time.size() > 1) break;
  }
  std::vector<Grid> grids;
  if (base.time.size() < 2 || !(typicalPeriod(base, kFarStep) <= kSlowest)) return grids;
  for (const TimeWindow& piece : cutAtFarSteps({{base.time.front(), base.time.back()}}, base.time))
    grids.push_back(gridOf(signals, piece));
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

std::vector<bool> upsetsOf(const Grid& grid) {
  const bool commanded = !grid.roll_cmd.empty() && !grid.pitch_cmd.empty();
  Values tilt(grid.size, kUnknown);
  for (std::size_t i = 0; i < grid.size && !grid.roll.empty() && !grid.pitch.empty(); ++i)
    tilt[i] = std::acos(std::clamp(std::cos(grid.roll[i]) * std::cos(grid.pitch[i]), -1.0, 1.0));
  std::vector<bool> upset(grid.size, false);
  for (std::size_t i = 1; i < grid.size; ++i) {
    double allowed = kTiltUncommanded;
    if (commanded) {
      const auto greatest = [&](const Values& command) {
        const Extent recent = extentOf(command, i < kCommandSteps ? 0 : i - kCommandSteps, i);
        return std::fmax(0.0, std::fmax(std::abs(recent.least), std::abs(recent.greatest)));
      };
      allowed =
          std::max(kTiltAllowed, kTiltBeyond + std::hypot(greatest(grid.roll_cmd), greatest(grid.pitch_cmd)));
    }
    // A single sample is an outlier.
    upset[i] = tilt[i] > allowed && tilt[i - 1] > kTiltAllowed;
  }
  return upset;
}

// What all pieces of a flight say of its levels. NaN: such a level tells nothing.
struct Levels {
  // Up to which the throttle is at its least, and a fixed wing does not fly [m/s].
  double throttle = kUnknown;
  double airspeed = kUnknown;
  // Height up to which the vehicle may stand, and from which on it flies [m].
  double low = kUnknown;
  double high = kUnknown;
};

Levels levelsOf(const std::vector<Grid>& grids) {
  const auto all = [&grids](Values Grid::*member) {
    Values values;
    for (const Grid& grid : grids) {
      std::copy_if((grid.*member).begin(), (grid.*member).end(), std::back_inserter(values),
                   [](double value) { return std::isfinite(value); });
    }
    return values;
  };
  Levels levels;
  const Values throttle = all(&Grid::throttle), airspeed = all(&Grid::airspeed), height = all(&Grid::height);
  if (!throttle.empty()) {
    const double least = *std::min_element(throttle.begin(), throttle.end());
    const double most = quantileOf(throttle, kRareShare);
    if (least >= 0.0 && most > kThrottleVaries * least)
      levels.throttle = std::max(kIdleShare * most, least + kIdleRange * (most - least));
  }
  if (quantileOf(airspeed, kRareShare) > kLeastCruise)
    levels.airspeed = kStallShare * quantileOf(airspeed, kRareShare);
  if (!height.empty()) {
    const auto [least, most] = std::minmax_element(height.begin(), height.end());
    if (*most - *least > kLeastHeightRange) {
      levels.low = *least + kLowShare * (*most - *least);
      levels.high = *least + kHighShare * (*most - *least);
    }
  }
  return levels;
}

// Whether the vehicle stands throughout [from, to], where the range of its angles is `angle`. What is not known is NaN and
// tells nothing.
bool standsIn(const Grid& grid, const Levels& levels, std::size_t from, std::size_t to, double angle) {
  const Extent speed = extentOf(grid.speed, from, to), throttle = extentOf(grid.throttle, from, to);
  const Extent airspeed = extentOf(grid.airspeed, from, to), height = extentOf(grid.height, from, to);
  if (speed.greatest > kFast || airspeed.greatest > levels.airspeed) return false;
  // Who carries a fixed wing to its start walks: then the airspeed tells.
  const bool slow = speed.greatest < kSlow || airspeed.greatest < levels.airspeed;
  if (std::isfinite(throttle.greatest) && std::isfinite(levels.throttle))
    return throttle.greatest <= levels.throttle && (slow || angle < kRestAngle);
  // Without a throttle, take-off and landing are taken to be at about one height.
  return angle < kDeepRestAngle && (slow || std::isnan(speed.greatest)) && height.greatest < levels.low;
}

// Where the vehicle stands, and where its attitude rests.
struct Ground {
  std::vector<bool> stands;
  std::vector<bool> rests;
};

Ground groundOf(const Grid& grid, const Levels& levels) {
  Ground ground = {std::vector<bool>(grid.size, false), std::vector<bool>(grid.size, false)};
  for (std::size_t from = 0; from + kStandSteps < grid.size; ++from) {
    const std::size_t to = from + kStandSteps;
    const Extent roll = extentOf(grid.roll, from, to), pitch = extentOf(grid.pitch, from, to);
    const double angle = roll.range() > pitch.range() ? roll.range() : pitch.range();
    const bool stands = standsIn(grid, levels, from, to, angle);
    for (std::size_t i = from; i <= to; ++i) {
      ground.rests[i] = ground.rests[i] || angle < kRestAngle;
      ground.stands[i] = ground.stands[i] || stands;
    }
  }
  return ground;
}

std::size_t stepsOf(double seconds) { return static_cast<std::size_t>(std::lround(seconds / kPhaseStep)); }

std::vector<Span> spansOf(const std::vector<bool>& flags, double join) {
  std::vector<Span> spans;
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (!flags[i]) continue;
    if (spans.empty() || i - spans.back().last > stepsOf(join)) spans.push_back({i, i});
    spans.back().last = i;
  }
  return spans;
}

void add(const Grid& grid, const Span& span, double before, double after, const char* reason,
         std::vector<RejectedWindow>* found) {
  const double end = grid.time(grid.size - 1) + kPhaseStep;
  const double from = std::max(grid.from, grid.time(span.first) - before);
  const double to = std::min(end, grid.time(span.last) + after);
  found->push_back(
      {{from - grid.from < kLeastFlight ? grid.from : from, end - to < kLeastFlight ? end : to}, reason});
}

// In order of time; what overlaps is cut, and what is left between two of one piece must be worth it.
std::vector<RejectedWindow> inOrder(std::vector<RejectedWindow> found) {
  std::stable_sort(found.begin(), found.end(), [](const RejectedWindow& one, const RejectedWindow& other) {
    return one.window.from < other.window.from;
  });
  std::vector<RejectedWindow> result;
  for (RejectedWindow& one : found) {
    if (!result.empty()) {
      RejectedWindow& before = result.back();
      const bool near = one.window.from - before.window.to < kLeastFlight;
      if (one.window.to <= before.window.to) continue;
      if (near && one.reason == before.reason) {
        before.window.to = one.window.to;
        continue;
      }
      if (near) one.window.from = before.window.to;
    }
    result.push_back(std::move(one));
  }
  return result;
}

}  // namespace

std::vector<RejectedWindow> findNonFlight(const FlightSignals& signals, bool on_ground) {
  const std::vector<Grid> grids = gridsOf(signals);
  const Levels levels = levelsOf(grids);
  std::vector<RejectedWindow> all;
  for (const Grid& grid : grids) {
    const Ground ground = groundOf(grid, levels);
    std::vector<RejectedWindow> found;
    for (Span span : spansOf(upsetsOf(grid), kUpsetJoin)) {
      for (std::size_t i = span.last; i < std::min(grid.size, span.last + stepsOf(kLiesWithin)); ++i) {
        if (ground.rests[i]) span.last = i;
      }
      add(grid, span, kUpsetBefore, kUpsetAfter, "upset, not commanded", &found);
    }
    if (!on_ground) {
      for (const Span& span : spansOf(ground.stands, kGroundJoin))
        add(grid, span, kGroundMargin, kGroundMargin, "on the ground", &found);
    }
    for (RejectedWindow& one : inOrder(std::move(found))) all.push_back(std::move(one));
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
