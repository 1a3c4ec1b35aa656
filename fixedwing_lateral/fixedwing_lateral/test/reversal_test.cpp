// Paths that lead back, circles flown the wrong way, paths far away, ends that are missed: what a mission
// must not get stuck on, and a roll reference that does not jump from bound to bound.
#include "fixedwing_lateral/reversal.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fixedwing_lateral/turn_limits.hpp"
#include "fixedwing_plant/aircraft.hpp"
#include "fixedwing_plant/flight_loop.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;

const Vector2d kNorthward(14.0, 0.0);
const Vector2d kCalm(0.0, 0.0);

TrackError against(double course) {
  TrackError error;
  error.course = course;
  error.course_defined = true;
  return error;
}

TEST(CourseError, StaysOnTheSideThatWasChosen) {
  for (double angle = -kPi; angle < kPi; angle += 0.1) {
    EXPECT_EQ(courseError(angle, Reversal::kNone), angle);
    for (const Reversal side : {Reversal::kLeft, Reversal::kRight}) {
      const double counted = courseError(angle, side);
      EXPECT_NEAR(wrapCourse(counted - angle), 0.0, 1e-12);
      const double turned = side == Reversal::kRight ? counted : -counted;
      EXPECT_GE(turned, -2.0 / 3.0 * kPi - 1e-12);
      EXPECT_LE(turned, 4.0 / 3.0 * kPi + 1e-12);
    }
  }
}

TEST(ReversalChoice, TurnsTowardsThePathOrIntoTheWindAndThenStays) {
  ReversalChoice choice;
  EXPECT_EQ(choice.update(against(1.5), {0.0, 30.0}, kNorthward, kCalm), Reversal::kNone);
  // The shorter way is to the left.
  EXPECT_EQ(choice.update(against(-2.3), {0.0, 30.0}, kNorthward, kCalm), Reversal::kLeft);
  // The side stays beyond half a turn.
  EXPECT_EQ(choice.update(against(3.1), {0.0, 30.0}, kNorthward, kCalm), Reversal::kLeft);
  EXPECT_EQ(choice.update(against(-1.0), {0.0, 30.0}, kNorthward, kCalm), Reversal::kLeft);
  EXPECT_EQ(choice.update(against(-0.7), {0.0, 30.0}, kNorthward, kCalm), Reversal::kNone);
  // The path is on the right.
  EXPECT_EQ(choice.update(against(-3.1), {0.0, 30.0}, kNorthward, kCalm), Reversal::kRight);
  choice.begin();
  // The wind comes from the left.
  EXPECT_EQ(choice.update(against(3.1), {0.0, 1.0}, kNorthward, {0.0, 5.0}), Reversal::kLeft);
  choice.begin();
  TrackError none;
  none.course = kPi;
  EXPECT_EQ(choice.update(none, {0.0, 30.0}, {0.0, 0.0}, kCalm), Reversal::kNone);
}

double leastRadiusFor(double airspeed, double wind_share) {
  TurnConditions conditions;
  conditions.airspeed = airspeed;
  conditions.wind_speed = wind_share * airspeed;
  conditions.roll *= 0.8;
  return leastRadius(conditions);
}

struct Flown {
  // Index of the last segment.
  int last = 0;
  // Start of the loiter; -1: none [s].
  double loitering = -1.0;
  // Number of jumps of the roll reference by half its range.
  int leaps = 0;
  // Largest distance from the path once settled on the loiter [m].
  double late = 0.0;
};

Flown fly(const Mission& mission, double airspeed, const Vector2d& wind, const AircraftState& start,
          const LateralWeights& weights, double gust = 0.0) {
  GuidanceOptions options;
  options.airspeed_nominal = airspeed;
  options.weights = weights;
  LateralGuidance guidance(options, "test");
  guidance.setMission(mission);
  RoughOptions plant;
  plant.airspeed = airspeed;
  plant.wind = wind;
  plant.gust = gust;
  PerturbedAircraft aircraft(plant, start, 2);
  Sensors sensors({}, 1);
  Flown flown;
  double before = 0.0;
  constexpr double kSettled = 80.0;  // on the loiter [s]
  double arrived = 600.0;
  const auto is_over = [&](const FlightSample& sample) {
    if (sample.output.loitering) arrived = std::min(arrived, sample.time);
    return sample.time > arrived + kSettled + 40.0;
  };
  for (const FlightSample& sample : flyLaw(aircraft, sensors, lawOf(guidance), 0.05, 600.0, is_over)) {
    EXPECT_GE(sample.output.segment, flown.last);
    EXPECT_LE(sample.output.segment, flown.last + 1);
    flown.leaps += std::abs(sample.roll_reference - before) > 0.6 ? 1 : 0;
    before = sample.roll_reference;
    flown.last = sample.output.segment;
    if (!sample.output.loitering) continue;
    if (flown.loitering < 0.0) flown.loitering = sample.time;
    if (sample.time > flown.loitering + kSettled)
      flown.late = std::max(flown.late, std::abs(sample.output.error.track));
  }
  return flown;
}

AircraftState at(const Vector2d& position, double heading, double airspeed) {
  AircraftState state;
  state.position = position;
  state.heading = heading;
  state.ground_velocity = airspeed * Vector2d(std::cos(heading), std::sin(heading));
  return state;
}

// A horizon of 4 s gains less in e_chi than a turn costs in e_t from 20 m/s on: without a decision it flies
// on, away from the path, for ever.
TEST(Reversal, LinesThereAndBackAreFlown) {
  for (const double airspeed : {14.0, 22.0, 25.0}) {
    for (const double share : {0.0, 0.5}) {
      LateralWeights published_track = defaultWeights();
      published_track.track = LateralWeights{}.track;
      std::vector<PathSegment> segments;
      for (int i = 0; i < 4; ++i) {
        const bool back = i % 2 == 1;
        segments.emplace_back(LineSegment{{back ? 400.0 : 0.0, 0.0}, {back ? 0.0 : 400.0, 0.0}});
      }
      LoiterOptions loiter;
      loiter.radius = leastRadiusFor(airspeed, share);
      const Mission mission = makeMission(segments, loiter, "test");
      for (const LateralWeights& weights : {defaultWeights(), published_track}) {
        const Flown flown = fly(mission, airspeed, airspeed * share * Vector2d(0.6, 0.8),
                                at({0.0, 0.0}, 0.0, airspeed), weights);
        EXPECT_EQ(flown.last, 4) << airspeed << ' ' << share;
        EXPECT_LT(flown.late, 3.0) << airspeed << ' ' << share;
        EXPECT_LE(flown.leaps, 8) << airspeed << ' ' << share;
      }
    }
  }
}

TEST(Reversal, ALoiterIsMetFromTheWrongSideToo) {
  for (const double airspeed : {14.0, 22.0}) {
    for (const TurnDirection direction : {TurnDirection::kLeft, TurnDirection::kRight}) {
      for (const double heading : {0.0, 1.6, 3.1}) {
        const double radius = leastRadiusFor(airspeed, 0.5);
        const Mission mission = makeMission({LoiterCircle{{0.0, 0.0}, radius, direction}}, {}, "test");
        const Flown flown = fly(mission, airspeed, airspeed * 0.5 * Vector2d(0.6, -0.8),
                                at({0.0, -radius}, heading, airspeed), defaultWeights(), 0.5);
        // This limit is for flight in gusts [m].
        EXPECT_LT(flown.late, 5.0) << airspeed << ' ' << heading;
        EXPECT_LE(flown.leaps, 4) << airspeed << ' ' << heading;
      }
    }
  }
}

// Far from a circle Gauss-Newton jumps from bound to bound at each call; the curvature of the motion keeps
// it.
TEST(Reversal, APathFarAwayIsJoinedWithoutJumps) {
  const Mission mission = makeMission({LoiterCircle{{0.0, 0.0}, 135.0, TurnDirection::kRight}}, {}, "test");
  const AircraftState start = at({400.0, 300.0}, 2.0, 14.0);
  LateralWeights plain = defaultWeights();
  plain.curvature = 0.0;
  EXPECT_GT(fly(mission, 14.0, {3.0, 4.0}, start, plain).leaps, 20);
  const Flown flown = fly(mission, 14.0, {3.0, 4.0}, start, defaultWeights());
  EXPECT_LE(flown.leaps, 2);
  EXPECT_LT(flown.late, 3.0);
}

// Arcs of 8 m at 22 m/s: no gate can be met. Each end is missed twice at most, in order.
TEST(Reversal, ArcsThatCannotBeFlownDoNotHoldUpAMission) {
  std::vector<PathSegment> segments;
  Vector2d place(0.0, 0.0);
  double course = 0.0;
  for (int i = 0; i < 4; ++i) {
    const Vector2d along(std::cos(course), std::sin(course));
    const Vector2d right(-along.y(), along.x());
    segments.emplace_back(LineSegment{place, place + 120.0 * along});
    segments.emplace_back(
        ArcSegment{place + 120.0 * along + 8.0 * right, 8.0, TurnDirection::kRight, course - kPi / 2.0, 2.8});
    place = pointAt(segments.back(), 8.0 * 2.8).position;
    course += 2.8;
  }
  const Mission mission = makeMission(segments, {200.0, TurnDirection::kRight}, "test");
  const Flown flown = fly(mission, 22.0, {5.0, 5.0}, at({0.0, 0.0}, 0.0, 22.0), defaultWeights());
  EXPECT_EQ(flown.last + 1, static_cast<int>(mission.segments.size()));
  EXPECT_LT(flown.late, 3.0);
}

}  // namespace
