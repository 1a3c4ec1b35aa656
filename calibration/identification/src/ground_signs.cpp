#include <algorithm>
#include <cmath>
#include <limits>

#include "flight_signs.hpp"

namespace polyfly {
namespace {

// Steps of a window in which the vehicle must stand throughout.
constexpr std::size_t kStandSteps = 40;
constexpr double kGravityAtRest = 9.8066;  // [m/s^2]
// Range of roll and pitch within a window up to which the attitude rests, with a throttle at its least, and with none
// [rad].
constexpr double kRestAngle = 0.03;
constexpr double kDeepRestAngle = 0.01;
// Speed up to which the vehicle may stand, and from which on it moves [m/s].
constexpr double kSlow = 0.5;
constexpr double kFast = 2.0;
// Throttle at its least, as a share of the throttle that is rarely exceeded, and as a share of its range.
constexpr double kIdleShare = 0.3;
constexpr double kIdleRange = 0.1;
constexpr double kRareShare = 0.98;
// Throttle that is rarely exceeded divided by its least, below which the throttle never was at its least.
constexpr double kThrottleVaries = 1.5;
// Share of the airspeed that is rarely exceeded up to which a fixed wing does not fly, and the least of it [m/s].
constexpr double kStallShare = 0.35;
constexpr double kLeastCruise = 6.0;
// Shares of the range of height, and the least range [m].
constexpr double kLowShare = 0.15;
constexpr double kHighShare = 0.5;
constexpr double kLeastHeightRange = 1.0;
// Share of the usual range of specific force within a window up to which it rests, and share of gravity by which it may
// differ from it.
constexpr double kQuietShare = 0.25;
constexpr double kGravityShare = 0.1;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

struct Extent {
  double least = std::numeric_limits<double>::infinity();
  double greatest = -std::numeric_limits<double>::infinity();
  // True: every value is known.
  bool whole = true;

  double range() const { return greatest - least; }
};

Extent extentOf(const std::vector<double>& values, std::size_t from) {
  Extent extent;
  extent.whole = !values.empty();
  for (std::size_t i = from; i <= from + kStandSteps && extent.whole; ++i) {
    extent.least = std::min(extent.least, values[i]);
    extent.greatest = std::max(extent.greatest, values[i]);
    extent.whole = std::isfinite(values[i]);
  }
  return extent;
}

// The finite values of all pieces, sorted.
std::vector<double> sortedValues(const std::vector<FlightGrid>& grids,
                                 std::vector<double> FlightGrid::*member) {
  std::vector<double> all;
  for (const FlightGrid& grid : grids) {
    for (const double value : grid.*member) {
      if (std::isfinite(value)) all.push_back(value);
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

double rarelyExceeded(const std::vector<double>& sorted, double share = kRareShare) {
  return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

double restOfForce(const std::vector<FlightGrid>& grids) {
  std::vector<double> ranges;
  for (const FlightGrid& grid : grids) {
    for (std::size_t i = 0; i + kStandSteps < grid.size && !grid.force.empty(); i += kStandSteps) {
      const Extent force = extentOf(grid.force, i);
      if (force.whole) ranges.push_back(force.range());
    }
  }
  if (ranges.empty()) return kNothing;
  std::sort(ranges.begin(), ranges.end());
  constexpr double kUsual = 0.75;
  return kQuietShare * rarelyExceeded(ranges, kUsual);
}

// Whether the vehicle stands in one window, and whether its attitude rests.
bool standsIn(const FlightGrid& grid, const FlightLevels& levels, std::size_t from, bool* rests) {
  const Extent roll = extentOf(grid.roll, from);
  const Extent pitch = extentOf(grid.pitch, from);
  const Extent speed = extentOf(grid.speed, from);
  const Extent throttle = extentOf(grid.thrust_cmd, from);
  const Extent airspeed = extentOf(grid.airspeed, from);
  const Extent height = extentOf(grid.height, from);
  const Extent force = extentOf(grid.force, from);
  const double angle = roll.whole && pitch.whole ? std::max(roll.range(), pitch.range()) : kNothing;
  *rests = angle < kRestAngle;
  if (speed.whole && speed.greatest > kFast) return false;
  if (airspeed.whole && airspeed.greatest > levels.airspeed_least) return false;
  // Who carries a fixed wing to its start walks: then the airspeed tells.
  const bool grounded = airspeed.whole && airspeed.greatest < levels.airspeed_least;
  const bool slow = (speed.whole && speed.greatest < kSlow) || grounded;
  const bool low = height.whole && height.greatest < levels.height_low;
  const bool quiet = force.whole && force.range() < levels.force_rest &&
                     std::abs(force.least - kGravityAtRest) < kGravityShare * kGravityAtRest;
  if (throttle.whole && std::isfinite(levels.throttle_least))
    return throttle.greatest <= levels.throttle_least && (slow || *rests);
  // Without a throttle, take-off and landing are taken to be at about one height.
  if (height.whole && height.least > levels.height_high) return false;
  const bool still = angle < kDeepRestAngle && (slow || !speed.whole);
  return still && (low || quiet);
}

}  // namespace

FlightLevels flightLevels(const std::vector<FlightGrid>& grids) {
  FlightLevels levels = {kNothing, kNothing, kNothing, kNothing, kNothing};
  const std::vector<double> throttle = sortedValues(grids, &FlightGrid::thrust_cmd);
  if (!throttle.empty()) {
    const double least = throttle.front();
    const double most = rarelyExceeded(throttle);
    if (least >= 0.0 && most > kThrottleVaries * least)
      levels.throttle_least = std::max(kIdleShare * most, least + kIdleRange * (most - least));
  }
  const std::vector<double> airspeed = sortedValues(grids, &FlightGrid::airspeed);
  if (!airspeed.empty() && rarelyExceeded(airspeed) > kLeastCruise)
    levels.airspeed_least = kStallShare * rarelyExceeded(airspeed);
  const std::vector<double> height = sortedValues(grids, &FlightGrid::height);
  if (!height.empty() && height.back() - height.front() > kLeastHeightRange) {
    const double range = height.back() - height.front();
    levels.height_low = height.front() + kLowShare * range;
    levels.height_high = height.front() + kHighShare * range;
  }
  levels.force_rest = restOfForce(grids);
  return levels;
}

GroundSigns groundSigns(const FlightGrid& grid, const FlightLevels& levels) {
  GroundSigns result;
  result.stands.assign(grid.size, false);
  result.rests = result.stands;
  for (std::size_t from = 0; from + kStandSteps < grid.size; ++from) {
    bool rests = false;
    const bool stands = standsIn(grid, levels, from, &rests);
    for (std::size_t i = from; i <= from + kStandSteps && (rests || stands); ++i) {
      result.rests[i] = result.rests[i] || rests;
      result.stands[i] = result.stands[i] || stands;
    }
  }
  return result;
}

}  // namespace polyfly
