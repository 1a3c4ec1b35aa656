#include "identification/flight_phases.hpp"

#include <algorithm>
#include <cmath>

#include "flight_signs.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

// An impact this close to an upset belongs to it [s].
constexpr double kHitReach = 1.0;
// Upsets that are closer are one [s].
constexpr double kUpsetJoin = 3.0;
// What an upset takes before and after it [s].
constexpr double kUpsetBefore = 0.5;
constexpr double kUpsetAfter = 1.5;
// A vehicle that rests this soon after an upset lies on the ground [s].
constexpr double kLiesWithin = 3.0;
// Flight between two stretches, or to the end, that is too short to count [s].
constexpr double kLeastFlight = 4.0;
// Stretches on the ground that are closer are one, and what landing and take-off take [s].
constexpr double kGroundJoin = 4.0;
constexpr double kGroundMargin = 0.5;

std::size_t stepsOf(double seconds) { return static_cast<std::size_t>(std::lround(seconds / kPhaseStep)); }

// Indices [first, last] of the grid.
struct Span {
  std::size_t first = 0;
  std::size_t last = 0;
};

std::vector<Span> spansOf(const std::vector<bool>& flags, double join) {
  std::vector<Span> spans;
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (!flags[i]) continue;
    if (!spans.empty() && i - spans.back().last <= stepsOf(join)) {
      spans.back().last = i;
    } else {
      spans.push_back({i, i});
    }
  }
  return spans;
}

// With the impacts around it, to the end of its rest or of the record.
Span wholeUpset(Span span, const UpsetSigns& signs, const GroundSigns& ground) {
  const std::size_t reach = stepsOf(kHitReach);
  const std::size_t end = signs.hit.size();
  for (std::size_t i = span.first < reach ? 0 : span.first - reach; i < span.first; ++i) {
    if (signs.hit[i]) span.first = i;
  }
  for (std::size_t i = span.last; i < std::min(end, span.last + reach); ++i) {
    if (signs.hit[i]) span.last = i;
  }
  for (std::size_t i = span.last; i < std::min(end, span.last + stepsOf(kLiesWithin)); ++i) {
    if (ground.rests[i]) span.last = i;
  }
  return span;
}

TimeWindow windowOf(const FlightGrid& grid, const Span& span, double before, double after) {
  const double end = grid.time(grid.size - 1) + kPhaseStep;
  const double from = std::max(grid.from, grid.time(span.first) - before);
  const double to = std::min(end, grid.time(span.last) + after);
  return {from - grid.from < kLeastFlight ? grid.from : from, end - to < kLeastFlight ? end : to};
}

void addUpsets(const FlightGrid& grid, const GroundSigns& ground, std::vector<RejectedWindow>* found) {
  const UpsetSigns signs = upsetSigns(grid);
  for (const Span& upset : spansOf(signs.upset, kUpsetJoin)) {
    const Span span = wholeUpset(upset, signs, ground);
    found->push_back({windowOf(grid, span, kUpsetBefore, kUpsetAfter), "upset, not commanded"});
  }
}

void addGround(const FlightGrid& grid, const GroundSigns& ground, std::vector<RejectedWindow>* found) {
  for (const Span& span : spansOf(ground.stands, kGroundJoin))
    found->push_back({windowOf(grid, span, kGroundMargin, kGroundMargin), "on the ground"});
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
      if (one.reason == before.reason && one.window.from - before.window.to < kLeastFlight) {
        before.window.to = std::max(before.window.to, one.window.to);
        continue;
      }
      if (one.window.to <= before.window.to) continue;
      if (one.window.from - before.window.to < kLeastFlight) one.window.from = before.window.to;
    }
    result.push_back(std::move(one));
  }
  return result;
}

}  // namespace

std::vector<RejectedWindow> findNonFlight(const FlightSignals& signals, bool on_ground) {
  const std::vector<FlightGrid> grids = flightGrids(signals);
  const FlightLevels levels = flightLevels(grids);
  std::vector<RejectedWindow> all;
  for (const FlightGrid& grid : grids) {
    const GroundSigns ground = groundSigns(grid, levels);
    std::vector<RejectedWindow> found;
    addUpsets(grid, ground, &found);
    if (!on_ground) addGround(grid, ground, &found);
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
