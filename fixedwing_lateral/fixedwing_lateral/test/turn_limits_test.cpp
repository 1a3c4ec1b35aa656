// Which circles can be flown in wind, and what becomes of missions with turns that cannot.
#include "fixedwing_lateral/turn_limits.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fixedwing_lateral/dubins.hpp"
#include "fixedwing_lateral/lateral_parameters.hpp"
#include "fixedwing_lateral/mission_file.hpp"
#include "fixedwing_plant/figures.hpp"
#include "fixedwing_plant/flight_metrics.hpp"
#include "polyfly_base/error.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;

constexpr double kAirspeed = 14.0;
constexpr double kRoll = 35.0 / 180.0 * kPi;

TurnConditions in(double wind) { return {kAirspeed, wind, kRoll}; }

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

TEST(LeastRadius, IsWhereTheSteepestRollIsTheBound) {
  EXPECT_NEAR(leastRadius(in(0.0)), 28.5, 0.05);
  EXPECT_NEAR(leastRadius(in(7.0)), 64.2, 0.05);
  EXPECT_TRUE(std::isinf(leastRadius(in(14.0))));
  for (const double wind : {0.0, 4.0, 12.0})
    EXPECT_NEAR(steepestRoll(circleOf(leastRadius(in(wind))), in(wind)), kRoll, 1e-12);
  EXPECT_THROW(checkTurns(in(14.0), "test"), Error);
  EXPECT_THROW(checkTurns({-1.0, 0.0, kRoll}, "test"), Error);
  EXPECT_THROW(checkTurns({14.0, 0.0, 1.6}, "test"), Error);
  EXPECT_THROW(checkTurns({14.0, std::nan(""), kRoll}, "test"), Error);
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
  EXPECT_EQ(complaint("{airspeed: 14, wind: 7, deviation: 2}").rfind("m:1: turns: deviation is removed", 0),
            0U);
  EXPECT_EQ(complaint("{airspeed: 14, wind: 7, speed: 2}").rfind("m:1: turns.speed: unknown key", 0), 0U);
}

/// What the second integral of a spread jump leaves beside the path, by Euler steps: the jump of the acceleration passes
/// a ramp of the roll or the roll loop, early by as much as makes the course right in the end.
double deviationBySimulation(const LateralModel& model, double jump, double ramp) {
  constexpr double kStep = 1e-4;
  constexpr double kEnd = 12.0;
  double roll = 0.0, rate = 0.0, lag = 0.0;
  for (double t = 0.0; t < kEnd; t += kStep) {
    const double reference = ramp > 0.0 ? std::min(1.0, t / ramp) : 1.0;
    rate += kStep * (model.a0 * (reference - roll) - model.a1 * rate);
    roll += kStep * rate;
    lag += kStep * (1.0 - roll);
  }
  double speed = 0.0, offset = 0.0;
  roll = rate = 0.0;
  for (double t = 0.0; t < kEnd; t += kStep) {
    const double reference = ramp > 0.0 ? std::min(1.0, t / ramp) : 1.0;
    rate += kStep * (model.a0 * (reference - roll) - model.a1 * rate);
    roll += kStep * rate;
    speed += kStep * jump * (roll - (t >= lag ? 1.0 : 0.0));
    offset += kStep * speed;
  }
  return offset;
}

TEST(Deviation, IsWhatASpreadJumpLeaves) {
  LateralModel quick;
  quick.a0 = 1e3;
  quick.a1 = 2.0 * std::sqrt(0.5 * quick.a0);  // the variance of its response is 0
  for (const double to : {0.05, 0.1}) {
    TurnConditions conditions;
    conditions.roll_variance = rollVariance(LateralModel{});
    const double jump = 9.81 * 2.0 * std::tan(to);
    EXPECT_NEAR(deviationOf(-to, to, conditions), deviationBySimulation(LateralModel{}, jump, 0.0),
                0.02 * jump * 0.1);
    conditions.roll_variance = rollVariance(quick);
    EXPECT_NEAR(conditions.roll_variance, 0.0, 1e-12);
    conditions.roll_rate = 0.1;
    const double expected = deviationBySimulation(quick, jump, 2.0 * to / conditions.roll_rate);
    EXPECT_NEAR(deviationOf(-to, to, conditions), expected, 0.01 * expected);
  }
  TurnConditions gained = in(0.0);
  gained.roll_rate = 0.5;
  const double whole = deviationOf(0.0, 0.4, gained);
  gained.turn_gain = 0.5;
  EXPECT_NEAR(deviationOf(0.0, 0.4, gained), 0.5 * whole, 1e-12);
}

TEST(LeastRadius, GrowsWithTheTurnsThatTheAircraftCannotDo) {
  for (const double wind : {0.0, 4.0, 7.0}) {
    TurnConditions conditions = in(wind);
    conditions.turn_gain = 0.8;
    EXPECT_NEAR(leastRadius(conditions), leastRadius(in(wind)) / 0.8, 1e-9);
    conditions.turn_bias = 0.05;
    const double radius = leastRadius(conditions);
    EXPECT_GT(radius, leastRadius(in(wind)) / 0.8);
    EXPECT_NEAR(steepestRoll(circleOf(radius), conditions), kRoll, 1e-9);
    // The oracle of the roll in flight: the bias against the turn.
    LateralConditions flown;
    flown.airspeed = kAirspeed;
    flown.wind = {wind, 0.0};
    flown.turn_gain = 0.8;
    flown.turn_bias = -0.05;
    EXPECT_NEAR(steepestRoll(circleOf(radius), {0.0, 0.0}, flown), kRoll, 1e-9);
  }
  TurnConditions hopeless = in(0.0);
  hopeless.turn_bias = 1.0;
  EXPECT_TRUE(std::isinf(leastRadius(hopeless)));
}

TEST(PlannedRoll, IsWhereAReversalDeviatesAsMuchAsItMay) {
  TurnConditions conditions = in(7.0);
  conditions.roll_rate = 0.3;
  EXPECT_EQ(plannedRoll(conditions), kRoll);  // no bound
  conditions.deviation = 2.0;
  const double roll = plannedRoll(conditions);
  EXPECT_LT(roll, kRoll);
  EXPECT_NEAR(deviationOf(-roll, roll, conditions), 2.0, 1e-6);
  const double radius = leastRadius(conditions);
  EXPECT_NEAR(radius, 441.0 / (9.81 * std::tan(roll)), 1e-9);
}

TEST(TurnPlan, OfTheNodeCountsWhatWasLearnt) {
  LateralParameters parameters;
  GuidanceOutput present;
  present.turn_gain = 0.85;
  present.turn_bias = -0.02;
  present.roll_bias = -0.03;
  present.wind = {3.0, 4.0};
  parameters.wind_expected = 2.0;
  parameters.guidance.model.roll_rate_max = 0.7;
  const TurnConditions conditions = turnPlanOf(parameters, present).conditions;
  EXPECT_EQ(conditions.turn_gain, 0.85);
  EXPECT_EQ(conditions.turn_bias, 0.02);
  EXPECT_EQ(conditions.wind_speed, 5.0);
  EXPECT_EQ(conditions.roll_rate, 0.7);
  EXPECT_NEAR(conditions.roll, 0.9 * (0.6108652382 - 0.03) * 13.48 / 13.97, 1e-9);
  EXPECT_NEAR(conditions.roll_variance, 0.0785, 1e-3);
  EXPECT_EQ(conditions.deviation, 1.5);
}

TEST(TurnPlan, OfAnUnknownRollRatePresumesOneThatFallsWithTheAirspeed) {
  LateralParameters parameters;
  const TurnConditions slow = turnPlanOf(parameters, {}).conditions;
  EXPECT_EQ(slow.roll_rate, 0.3);
  EXPECT_EQ(presumedRollRate(8.0), 0.3);
  parameters.guidance.airspeed_nominal = 42.0;
  EXPECT_NEAR(turnPlanOf(parameters, {}).conditions.roll_rate, 0.1, 1e-12);
  // A rate that is known makes turns tighter.
  parameters.guidance.model.roll_rate_max = 1.0;
  EXPECT_GT(plannedRoll(turnPlanOf(parameters, {}).conditions), plannedRoll(slow));
}

// An aircraft that turns too little by its roll and rolls slowly, in wind: planned by what is known of it, the sequence is
// held as well as the bar asks; planned by share and model alone it is left.
TEST(TurnPlan, ByGainAndRollRateIsHeld) {
  constexpr double kSpeed = 22.0;
  constexpr double kSize = kSpeed * kSpeed / (kAirspeed * kAirspeed);
  for (const double share : {0.3, 0.5}) {
    RoughOptions rough;
    rough.airspeed = kSpeed;
    rough.roll_rate_max = 0.6;
    rough.roll_frequency = 3.0;
    rough.turn_gain = 0.88;
    rough.load_drag = 2.0;
    rough.wind = share * kSpeed * Vector2d(0.6, -0.8);
    const auto largest = [&](const GuidanceOptions& options, const TurnPlan& plan) {
      const Mission mission = dubinsFigure(plan, kSize);
      AircraftState start;
      start.ground_velocity = {kSpeed, 0.0};
      PerturbedAircraft aircraft(rough, start, 1);
      LateralGuidance guidance(options, "test");
      guidance.setMission(mission);
      Sensors sensors({}, 1);
      const auto samples = flyLaw(aircraft, sensors, lawOf(guidance), 0.05, 380.0);
      return flightMetrics(mission.segments, samples, 0.5, 7.0).after_joining;
    };
    GuidanceOptions options;
    options.airspeed_nominal = kSpeed;
    TurnPlan by_share;
    by_share.tight = TightTurns::kWiden;
    by_share.conditions = {kSpeed, share * kSpeed, 0.9 * kRoll};
    const double before = largest(options, by_share);
    LateralParameters parameters;
    parameters.guidance = options;
    parameters.guidance.model.roll_rate_max = rough.roll_rate_max;
    parameters.guidance.model.a0 = parameters.guidance.model.b0 = 9.0;
    // The delay of 0.1 s counts in the mean delay a1 / a0 of the loop, as in a calibration without a delay of its own.
    parameters.guidance.model.a1 = 9.0 * (2.0 * rough.roll_damping / rough.roll_frequency + rough.roll_delay);
    parameters.tight_turns = "widen";
    parameters.wind_expected = share * kSpeed;
    GuidanceOutput learnt;
    learnt.turn_gain = 0.88;
    const double after = largest(parameters.guidance, turnPlanOf(parameters, learnt));
    RecordProperty("by_share_m", std::to_string(before));
    RecordProperty("by_plan_m", std::to_string(after));
    EXPECT_GT(before, 6.0) << share;
    EXPECT_LT(after, 3.0) << share;
  }
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
  const Flown wide = fly(leastRadius({kAirspeed, 7.0, 0.9 * kRoll}));
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
