// Which circles can be flown in wind, and what becomes of missions with turns that cannot.
#include "fixedwing_lateral/turn_limits.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fixedwing_lateral/mission_file.hpp"
#include "fixedwing_plant/figures.hpp"
#include "fixedwing_plant/flight_metrics.hpp"
#include "polyfly_base/error.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;

constexpr double kAirspeed = 14.0;
constexpr double kRoll = 35.0 / 180.0 * kPi;

TurnConditions in(double wind) { return {kAirspeed, wind, kRoll, 9.81}; }

LoiterCircle circleOf(double radius) { return {{0.0, 0.0}, radius, TurnDirection::kRight}; }

/// By differences of the heading that keeps a course in a wind that blows to the north; no formula for the
/// roll.
double rollByDifferences(double course, double turn, double radius, double wind) {
  const auto heading_at = [&](double at) { return at - std::asin(wind / kAirspeed * std::sin(-at)); };
  const double heading = heading_at(course);
  const double north = kAirspeed * std::cos(heading) + wind;
  const double east = kAirspeed * std::sin(heading);
  EXPECT_NEAR(wrapCourse(std::atan2(east, north) - course), 0.0, 1e-9);
  constexpr double kStep = 1e-5;
  const double rate = (heading_at(course + kStep) - heading_at(course - kStep)) / (2.0 * kStep) *
                      std::hypot(north, east) / radius;
  return std::atan(kAirspeed * turn * rate / 9.81);
}

TEST(SteepestRoll, IsThatOfACircleFlownInWind) {
  constexpr double kRadius = 60.0;
  for (const double wind : {0.0, 3.0, 7.0, 10.0, 13.5}) {
    double steepest = 0.0;
    for (double course = -kPi; course < kPi; course += 1e-3)
      steepest = std::max(steepest, rollByDifferences(course, 1.0, kRadius, wind));
    EXPECT_NEAR(steepestRoll(circleOf(kRadius), in(wind)), steepest, 1e-5) << wind;
  }
  EXPECT_EQ(steepestRoll(LineSegment{{0.0, 0.0}, {9.0, 0.0}}, in(5.0)), 0.0);
  EXPECT_EQ(steepestRoll(circleOf(kRadius), in(14.0)), kPi / 2.0);
}

TEST(SteepestRoll, OfAnArcCountsTheCoursesThatItHas) {
  LateralConditions conditions;
  conditions.airspeed = kAirspeed;
  conditions.wind = {7.0, 0.0};
  for (const TurnDirection direction : {TurnDirection::kLeft, TurnDirection::kRight}) {
    const double turn = direction == TurnDirection::kRight ? 1.0 : -1.0;
    for (double start = -3.0; start < 3.0; start += 0.37) {
      for (const double sweep : {0.1, 1.0, 3.0, 6.0}) {
        const ArcSegment arc{{0.0, 0.0}, 50.0, direction, start, sweep};
        double steepest = 0.0;
        for (int i = 0; i <= 2000; ++i) {
          const double course = start + turn * (sweep * i / 2000.0 + kPi / 2.0);
          steepest = std::max(steepest, std::abs(rollByDifferences(wrapCourse(course), turn, 50.0, 7.0)));
        }
        EXPECT_NEAR(steepestRoll(arc, {0.0, 0.0}, conditions, 9.81), steepest, 1e-5) << start << ' ' << sweep;
      }
    }
  }
  EXPECT_NEAR(steepestRoll(circleOf(60.0), {0.0, 0.0}, conditions, 9.81),
              steepestRoll(circleOf(60.0), in(7.0)), 1e-12);
}

TEST(LeastRadius, IsWhereTheSteepestRollIsTheBound) {
  EXPECT_NEAR(leastRadius(in(0.0)), 28.5, 0.05);
  EXPECT_NEAR(leastRadius(in(7.0)), 64.2, 0.05);
  EXPECT_TRUE(std::isinf(leastRadius(in(14.0))));
  for (const double wind : {0.0, 4.0, 12.0})
    EXPECT_NEAR(steepestRoll(circleOf(leastRadius(in(wind))), in(wind)), kRoll, 1e-12);
  EXPECT_THROW(checkTurns(in(14.0), "test"), Error);
  EXPECT_THROW(checkTurns({-1.0, 0.0, kRoll, 9.81}, "test"), Error);
  EXPECT_THROW(checkTurns({14.0, 0.0, 1.6, 9.81}, "test"), Error);
  EXPECT_THROW(checkTurns({14.0, std::nan(""), kRoll, 9.81}, "test"), Error);
}

TEST(FitTurns, KeepsRefusesOrWidens) {
  const std::vector<PathSegment> line = {LineSegment{{0.0, 0.0}, {200.0, 0.0}}};
  const Mission tight = makeMission(line, {60.0, TurnDirection::kLeft}, "test");
  EXPECT_EQ(std::get<LoiterCircle>(fitTurns(tight, {TightTurns::kKeep, in(7.0)}, "m").segments[1]).radius,
            60.0);
  try {
    fitTurns(tight, {TightTurns::kRefuse, in(7.0)}, "m");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(
        error.what(),
        "m: segment 1 asks for 36.8 degrees of roll where 35.0 are allowed: at 14.0 m/s in a wind of 7.0 m/s "
        "circles need 64.2 m");
  }
  const Mission wide = fitTurns(tight, {TightTurns::kWiden, in(7.0)}, "m");
  const auto& loiter = std::get<LoiterCircle>(wide.segments[1]);
  EXPECT_NEAR(loiter.radius, leastRadius(in(7.0)), 1e-9);
  const ClosestPoint met = closestPoint(loiter, {200.0, 0.0});
  // Place and direction are as before.
  EXPECT_LT((met.point.position - Vector2d(200.0, 0.0)).norm(), 1e-9);
  EXPECT_LT((met.point.tangent - Vector2d(1.0, 0.0)).norm(), 1e-9);
  const Mission alone =
      fitTurns(makeMission({circleOf(60.0)}, {}, "test"), {TightTurns::kWiden, in(7.0)}, "m");
  EXPECT_EQ(std::get<LoiterCircle>(alone.segments[0]).centre, Vector2d(0.0, 0.0));
  const ArcSegment arc{{0.0, 0.0}, 40.0, TurnDirection::kRight, 0.0, 2.0};
  EXPECT_THROW(fitTurns(makeMission({arc}, {}, "test"), {TightTurns::kWiden, in(7.0)}, "m"), Error);
  EXPECT_THROW(tightTurnsOf("warn", "test"), Error);
}

TEST(FitTurns, AFilePlansDubinsPathsForItsWind) {
  const std::string path = "path:\n  - dubins: {poses: [[0, 0, 0], [300, 100, 1.5], [0, 300, 3.0]]}\n";
  const Mission mission = parseMission("turns: {airspeed: 14, wind: 7, tight: widen}\n" + path, "m", {});
  EXPECT_TRUE(steepSegments(mission.segments, in(7.0)).empty());
  EXPECT_NEAR(std::get<ArcSegment>(mission.segments[0]).radius, leastRadius(in(7.0)), 1e-9);
  EXPECT_THROW(parseMission(path, "m", {}), Error);  // no radius and no wind
  const auto complaint = [&](const std::string& turns) -> std::string {
    try {
      parseMission("turns: " + turns + "\n" + path, "m", {});
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_EQ(complaint("{airspeed: 14}"), "m:1: turns.wind: missing");
  EXPECT_EQ(complaint("{airspeed: 14, wind: 14}"),
            "m:1: turns: turns: wind: must be at least 0 and below the airspeed, got 14.000000");
  EXPECT_EQ(complaint("{airspeed: 14, wind: 7, tight: maybe}"),
            "m:1: turns: tight: must be keep, refuse or widen, got 'maybe'");
  EXPECT_EQ(
      complaint("{airspeed: 14, wind: 7, roll: 2}").rfind("m:1: turns: turns: roll: must lie between", 0),
      0U);
  EXPECT_EQ(complaint("{airspeed: 14, wind: 7, speed: 2}").rfind("m:1: turns.speed: unknown key", 0), 0U);
}

struct Flown {
  // Largest distance from the circle, once joined [m].
  double largest = 0.0;
  // Largest roll reference [rad].
  double reference = 0.0;
  bool warned = false;
};

Flown fly(double radius) {
  LateralGuidance guidance(GuidanceOptions{}, "test");
  guidance.setMission(makeMission({circleOf(radius)}, {}, "test"));
  AircraftState start;
  start.position = {0.0, -radius};
  start.ground_velocity = {kAirspeed, 0.0};
  ChapterAircraft aircraft(LateralModel{}, start, kAirspeed, {4.2, -5.6});
  Sensors sensors({}, 1);
  Flown flown;
  for (const FlightSample& sample : flyLaw(aircraft, sensors, lawOf(guidance), 0.05, 150.0)) {
    flown.reference = std::max(flown.reference, std::abs(sample.roll_reference));
    flown.warned = flown.warned || sample.output.reason == GuidanceReason::kTooSteep;
    if (sample.time > 60.0)
      flown.largest = std::max(flown.largest, std::abs(sample.truth.position.norm() - radius));
  }
  return flown;
}

// In a wind of half the airspeed: from the least radius on circles are held; one that cannot be flown is left
// by a bounded distance, at the bound of the roll, and said to be so.
TEST(UnflyableCircle, IsLeftBoundedlyAndSaid) {
  const Flown wide = fly(leastRadius({kAirspeed, 7.0, 0.9 * kRoll, 9.81}));
  EXPECT_LT(wide.largest, 1.0);
  EXPECT_FALSE(wide.warned);
  EXPECT_LT(fly(leastRadius(in(7.0))).largest, 3.0);
  for (const double radius : {60.0, 50.0, 40.0}) {
    const Flown tight = fly(radius);
    EXPECT_TRUE(tight.warned) << radius;
    EXPECT_GT(tight.largest, 3.0) << radius;
    EXPECT_LT(tight.largest, 2.0 * (leastRadius(in(7.0)) - radius)) << radius;
    EXPECT_LE(tight.reference, kRoll + 1e-12) << radius;
  }
}

TEST(UnflyableCircle, TheDubinsFigureIsPlannedForItsWind) {
  const Mission mission = dubinsFigure(turnsInWind(7.0));
  EXPECT_TRUE(steepSegments(mission.segments, turnsInWind(7.0).conditions).empty());
  EXPECT_FALSE(steepSegments(dubinsFigure().segments, in(7.0)).empty());
  LateralGuidance guidance(GuidanceOptions{}, "test");
  guidance.setMission(mission);
  AircraftState start;
  start.ground_velocity = {kAirspeed, 0.0};
  ChapterAircraft aircraft(LateralModel{}, start, kAirspeed, {4.2, -5.6});
  Sensors sensors({}, 1);
  const auto samples = flyLaw(aircraft, sensors, lawOf(guidance), 0.05, 240.0);
  const FlightMetrics metrics = flightMetrics(mission.segments, samples, 0.5, 7.0);
  ASSERT_TRUE(metrics.has_joined);
  EXPECT_LT(metrics.joined, 15.0);
  EXPECT_LT(metrics.after_joining, 3.0);
  EXPECT_LT(metrics.loiter, 3.0);
}

}  // namespace
