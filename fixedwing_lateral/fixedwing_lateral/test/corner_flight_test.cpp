// Random paths of lines with corners of all angles, beside L1 guidance: the distance to the nearest segment over whole flights.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "fixedwing_lateral/l1_guidance.hpp"
#include "fixedwing_plant/figures.hpp"
#include "fixedwing_plant/flight_metrics.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;

constexpr double kFast = 52.0;
constexpr double kScale = kFast / 14.0;
constexpr double kLongest = 2000.0;  // [s]

double radians(double degrees) { return degrees / 180.0 * kPi; }

/// Seven lines of 200 to 500 m times s^2, with corners to both sides from `least` to 180 degrees.
Mission cornersFrom(double least, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> length(200.0, 500.0);
  std::uniform_real_distribution<double> corner(radians(least), kPi);
  std::bernoulli_distribution is_right(0.5);
  std::vector<Vector2d> points = {{0.0, 0.0}};
  double course = 0.0;
  for (int i = 0; i < 7; ++i) {
    const Vector2d along(std::cos(course), std::sin(course));
    points.push_back(points.back() + kScale * kScale * length(random) * along);
    const double angle = corner(random);
    course += is_right(random) ? angle : -angle;
  }
  return missionThrough(points, {}, "corners");
}

/// Until the path is over; infinite where it does not end [m].
double rmsOf(const Mission& mission, const Vector2d& wind, const LateralLaw& law) {
  AircraftState start;
  start.ground_velocity = {kFast, 0.0};
  RoughOptions options = slowRolling();
  options.wind = wind;
  PerturbedAircraft aircraft(options, start, 1);
  Sensors sensors({}, 1);
  const auto samples = flyLaw(aircraft, sensors, law, 0.05, kLongest,
                              [](const FlightSample& sample) { return sample.output.loitering; });
  if (!samples.back().output.loitering) return std::numeric_limits<double>::infinity();
  return flightMetrics(mission.segments, samples, 0.5, 7.0 * kScale).rms;
}

double rmsByDefaults(const Mission& mission, const Vector2d& wind) {
  GuidanceOptions options;
  options.airspeed_nominal = kFast;
  LateralGuidance guidance(options, "test");
  guidance.setMission(mission);
  return rmsOf(mission, wind, lawOf(guidance));
}

// By its best period, with the radius of its turn as the acceptance radius.
double leastRmsOfL1(const Mission& mission, const Vector2d& wind) {
  double least = std::numeric_limits<double>::infinity();
  for (const double period : {16.0, 25.0, leastL1Period(kFast, L1Options{}), 40.0}) {
    L1Options options;
    options.period = period;
    SwitchCriterion criterion;
    criterion.acceptance_radius = kScale * kScale * 28.5;
    L1Guidance guidance(mission, criterion, options);
    least = std::min(
        least, rmsOf(mission, wind, [&](const GuidanceInput& input) { return guidance.update(input); }));
  }
  return least;
}

// On each of these paths, in each wind.
TEST(Corners, OfSeededPathsCostNoMoreThanByTheBestL1) {
  for (const double least : {0.0, 120.0}) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const Mission mission = cornersFrom(least, seed);
      const double from = 2.0 * seed;  // direction of the wind [rad]
      const Vector2d wind = 0.25 * (seed - 1) * kFast * Vector2d(std::cos(from), std::sin(from));
      EXPECT_LE(rmsByDefaults(mission, wind), leastRmsOfL1(mission, wind)) << least << ' ' << seed;
    }
  }
}

// Wind across: with it the turn of 180 degrees would be pushed on by more than its own diameter.
TEST(Corners, AReversalTurnsIntoTheWindFromEitherSide) {
  const double side = 400.0 * kScale * kScale;
  for (const double across : {-1.0, 1.0}) {
    const Mission mission = missionThrough({{0.0, 0.0}, {side, 0.0}, {0.0, 0.0}}, {}, "test");
    const Vector2d wind(0.0, across * 0.5 * kFast);
    const double flown = rmsByDefaults(mission, wind);
    EXPECT_LT(flown, 65.0) << across;  // to the other side 490
    EXPECT_LE(flown, leastRmsOfL1(mission, wind)) << across;
  }
}

}  // namespace
