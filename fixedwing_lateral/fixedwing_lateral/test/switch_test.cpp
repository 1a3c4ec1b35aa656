// The switch condition (Eq. 47): where it holds, where not, and what x_sw makes of it.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "fixedwing_lateral/model.hpp"
#include "fixedwing_lateral/speed_scaling.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;
using Index = LateralIndex;

const LineSegment kNorthward{{0.0, 0.0}, {200.0, 0.0}};

SwitchGate gateOf(const PathSegment& segment) { return SwitchGate(segment); }

Vector2d course(double degrees) {
  return 14.0 * Vector2d(std::cos(degrees * kPi / 180.0), std::sin(degrees * kPi / 180.0));
}

TEST(SwitchGate, NeedsTheAcceptanceRadiusAndTheCourse) {
  const SwitchGate gate = gateOf(kNorthward);
  EXPECT_FALSE(gate.isMet({164.9, 0.0}, course(0.0)));
  EXPECT_TRUE(gate.isMet({165.1, 0.0}, course(0.0)));
  EXPECT_TRUE(gate.isMet({200.0, 34.9}, course(0.0)));
  EXPECT_FALSE(gate.isMet({200.0, 35.1}, course(0.0)));
  EXPECT_TRUE(gate.isMet({220.0, 0.0}, course(0.0)));  // just past the end
  for (const double side : {-1.0, 1.0}) {
    EXPECT_TRUE(gate.isMet({190.0, 0.0}, course(side * 44.9)));
    EXPECT_FALSE(gate.isMet({190.0, 0.0}, course(side * 45.1)));
  }
  EXPECT_FALSE(gate.isMet({190.0, 0.0}, course(180.0)));
}

TEST(SwitchGate, IsClosedWithoutACourseAndForNaN) {
  const SwitchGate gate = gateOf(kNorthward);
  EXPECT_FALSE(gate.isMet({190.0, 0.0}, Vector2d::Zero()));
  EXPECT_FALSE(gate.isMet({190.0, 0.0}, {0.5 * kLeastGroundSpeed, 0.0}));
  EXPECT_FALSE(gate.isMet({190.0, 0.0}, {std::nan(""), 0.0}));
  EXPECT_FALSE(gate.isMet({std::nan(""), 0.0}, course(0.0)));
}

TEST(SwitchGate, NeverOpensOnALoiterOrByDefault) {
  const SwitchGate loiter = gateOf(LoiterCircle{{0.0, 0.0}, 60.0, TurnDirection::kRight});
  for (int degrees = 0; degrees < 360; degrees += 5) {
    const double bearing = degrees * kPi / 180.0;
    const Vector2d position = 60.0 * Vector2d(std::cos(bearing), std::sin(bearing));
    EXPECT_FALSE(loiter.isMet(position, course(degrees + 90.0)));
    EXPECT_FALSE(SwitchGate().isMet(position, course(degrees + 90.0)));
  }
}

// An arc of 350 degrees begins 10 degrees, about 10 m, after its end, in nearly the same direction.
TEST(SwitchGate, DoesNotSkipAnArcThatBeginsNearItsEnd) {
  for (const TurnDirection direction : {TurnDirection::kLeft, TurnDirection::kRight}) {
    const double turn = direction == TurnDirection::kRight ? 1.0 : -1.0;
    const double sweep = 350.0;
    const SwitchGate gate = gateOf(ArcSegment{{0.0, 0.0}, 60.0, direction, 0.0, sweep * kPi / 180.0});
    int opened = 0;
    for (int degrees = -4; degrees <= 354; ++degrees) {
      const double bearing = turn * degrees * kPi / 180.0;
      const Vector2d position = 60.0 * Vector2d(std::cos(bearing), std::sin(bearing));
      const bool met = gate.isMet(position, course(turn * (degrees + 90.0)));
      // The chord to the end is shorter than 35 m within 33.9 degrees of it.
      EXPECT_EQ(met, degrees > sweep - 33.9) << degrees;
      opened += met ? 1 : 0;
    }
    EXPECT_GT(opened, 30);
  }
}

// A corner to the east, at the end of the way north.
TEST(SwitchGate, AtItsBisectorIsMetWhereTheNextSegmentIsNearer) {
  SwitchGate gate = gateOf(kNorthward);
  gate.bisect({0.0, 1.0});
  for (double north = 170.0; north <= 230.0; north += 2.0) {
    for (double east = -29.0; east <= 31.0; east += 2.0) {
      const Vector2d position(north, east);
      const Vector2d from_corner(north - 200.0, east);
      if (from_corner.norm() > 49.4) continue;
      const double from_next = east < 0.0 ? from_corner.norm() : std::abs(north - 200.0);
      const double from_this = north > 200.0 ? from_corner.norm() : std::abs(east);
      if (std::abs(from_next - from_this) < 1e-9) continue;  // beyond both ends, and on the bisector itself
      EXPECT_EQ(gate.isMet(position, course(45.0)), from_next < from_this) << north << ' ' << east;
    }
  }
  // The acceptance radius of 35 m, divided by the cosine of 45 degrees, is 49.5 m.
  EXPECT_TRUE(gate.isMet({200.0, 49.4}, course(45.0)));
  EXPECT_FALSE(gate.isMet({200.0, 49.6}, course(45.0)));
  gate.shapeCorner({2.0, 0.0});
  EXPECT_TRUE(gate.isMet({200.0, 98.9}, course(45.0)));
  EXPECT_FALSE(gate.isMet({200.0, 99.1}, course(45.0)));
  EXPECT_FALSE(gate.isOutOfReach({100.0, 0.0}, 1.1));
  EXPECT_TRUE(gate.isOutOfReach({100.0, 0.0}, 0.9));
}

TEST(SwitchGate, AtItsBisectorTakesCoursesBetweenBothDirections) {
  SwitchGate gate = gateOf(kNorthward);
  gate.bisect({0.0, 1.0});
  for (double degrees = -179.5; degrees < 180.0; degrees += 3.0) {
    const bool is_between = degrees > -45.0 && degrees < 135.0;
    EXPECT_EQ(gate.isMet({199.0, 4.0}, course(degrees)), is_between) << degrees;
  }
  EXPECT_FALSE(gate.isMet({199.0, 4.0}, Vector2d::Zero()));
  EXPECT_FALSE(gate.isMet({std::nan(""), 4.0}, course(45.0)));
}

TEST(SwitchGate, AtItsBisectorKeepsThePublishedConditionForLawsThatAskForIt) {
  SwitchGate gate = gateOf(kNorthward);
  gate.bisect({0.0, 1.0});
  EXPECT_FALSE(gate.isMet({170.0, 0.0}, course(0.0)));
  EXPECT_TRUE(gate.isMetAsPublished({170.0, 0.0}, course(0.0)));
  EXPECT_FALSE(gate.isMetAsPublished({170.0, 0.0}, course(50.0)));
}

// A law that does not look ahead switches a corner on the radius: that of the ground speed in the corner's own direction.
TEST(SwitchGate, AsPublishedGrowsWithTheSpeedInTheDirectionOfItsCorner) {
  SwitchGate gate = gateOf(kNorthward);
  gate.bisect({0.0, 1.0});
  const Vector2d between = Vector2d(1.0, 1.0).normalized();
  CornerConditions conditions;
  conditions.airspeed = 52.0;
  // (wind along the corner, speed over ground) [m/s]; the wind across does not count.
  for (const auto& [along, speed] : {std::pair(0.0, 52.0), std::pair(26.0, 78.0), std::pair(-26.0, 26.0)}) {
    conditions.wind = along * between + 20.0 * Vector2d(-between.y(), between.x());
    gate.shapeCorner(cornerShapeOf(gate, conditions, 14.0, LateralModel{}));
    const double radius = 35.0 * speed / 14.0 * speed / 14.0;
    EXPECT_TRUE(gate.isMetAsPublished({200.0, 0.999 * radius}, course(0.0))) << along;
    EXPECT_FALSE(gate.isMetAsPublished({200.0, 1.001 * radius}, course(0.0))) << along;
  }
  // Below the airspeed of the options, and where nothing is scaled, it stays.
  conditions.wind = -45.0 * between;
  for (const double scaled_airspeed : {14.0, 0.0}) {
    gate.shapeCorner(cornerShapeOf(gate, conditions, scaled_airspeed, LateralModel{}));
    EXPECT_TRUE(gate.isMetAsPublished({200.0, 34.9}, course(0.0)));
    EXPECT_FALSE(gate.isMetAsPublished({200.0, 35.1}, course(0.0)));
  }
}

TEST(SwitchGate, ASharpCornerIsSwitchedAsPublished) {
  for (const double degrees : {-160.0, -121.0, -119.0, 90.0, 119.0, 121.0, 180.0}) {
    SwitchGate gate = gateOf(kNorthward);
    gate.bisect(course(degrees).normalized());
    const bool is_sharp = std::abs(degrees) > 120.0;
    EXPECT_EQ(gate.isBisected(), !is_sharp) << degrees;
    EXPECT_EQ(gate.isMet({170.0, 0.0}, course(0.0)), is_sharp) << degrees;
  }
}

// The place on the bisector that the turn touching both lines passes lies within the radius, and so does its begin.
TEST(SwitchGate, TheTurnOntoBothSegmentsLiesWithinTheRadiusOfABisector) {
  constexpr double kTurn = 34.9;  // radius [m], below the acceptance radius
  for (const double degrees : {20.0, 60.0, 100.0, 119.0}) {
    const double half = degrees / 360.0 * kPi;
    SwitchGate gate = gateOf(LineSegment{{-1e4, 0.0}, {0.0, 0.0}});
    gate.bisect(course(degrees).normalized());
    const Vector2d begin(-kTurn * std::tan(half), 0.0);
    const Vector2d centre = begin + Vector2d(0.0, kTurn);
    const Vector2d middle = centre + kTurn * Vector2d(std::sin(half), -std::cos(half));
    for (const Vector2d& place : {begin, middle}) EXPECT_FALSE(gate.isOutOfReach(place, 0.0)) << degrees;
    const Vector2d along(std::cos(half), std::sin(half));
    EXPECT_FALSE(gate.isMet(middle - 0.1 * along, course(degrees / 2.0))) << degrees;
    EXPECT_TRUE(gate.isMet(middle + 0.1 * along, course(degrees / 2.0))) << degrees;
  }
}

TEST(SwitchGate, WithoutAnEndHasNoBisector) {
  SwitchGate never;
  never.bisect({0.0, 1.0});
  EXPECT_FALSE(never.isMet({1.0, 1.0}, course(45.0)));
}

// The turn ends the other way, so wind from ahead does not make its radius smaller.
TEST(SwitchGate, AsPublishedGrowsAtAReversalWithTheGreaterSpeed) {
  SwitchGate gate = gateOf(LineSegment{{-2000.0, 0.0}, {0.0, 0.0}});
  gate.bisect({-1.0, 0.0});
  CornerConditions conditions;
  conditions.airspeed = 52.0;
  for (const auto& [along, speed] : {std::pair(0.0, 52.0), std::pair(26.0, 78.0), std::pair(-26.0, 52.0)}) {
    conditions.wind = {along, 20.0};
    gate.shapeCorner(cornerShapeOf(gate, conditions, 14.0, LateralModel{}));
    const double radius = 35.0 * speed / 14.0 * speed / 14.0;
    EXPECT_TRUE(gate.isMet({-0.999 * radius, 0.0}, course(0.0))) << along;
    EXPECT_FALSE(gate.isMet({-1.001 * radius, 0.0}, course(0.0))) << along;
  }
}

// Through the horizon: x_sw waits, rises by alpha from the gate on, and goes on rising where the condition is
// lost again, even though the aircraft has turned away.
TEST(LateralSwitch, StateRisesForGoodOnceItHasSwitched) {
  const LateralModel model;
  LateralConditions conditions;
  conditions.gate = gateOf(kNorthward);
  LateralState state = LateralState::Zero();
  state[Index::kNorth] = 120.0;
  double met_at = -1.0;
  for (int i = 0; i < 200; ++i) {
    const double time = 0.1 * i;
    const bool met = (state.head<2>() - Vector2d(200.0, 0.0)).norm() < 35.0;
    if (met && met_at < 0.0) met_at = time;
    if (met_at < 0.0) {
      EXPECT_EQ(state[Index::kSwitch], 0.0);
    } else {
      // The step that entered the circle may have found it in its later stages.
      EXPECT_GE(state[Index::kSwitch], time - met_at - 1e-9);
      EXPECT_LE(state[Index::kSwitch], time - met_at + 0.1 + 1e-9);
    }
    state = integrate(model, conditions, state, {0.3, 0.1});
  }
  EXPECT_GT(met_at, 0.0);
  EXPECT_FALSE(conditions.gate.isMet(state.head<2>(), groundVelocity(conditions, state[Index::kHeading])));
  EXPECT_TRUE(hasSwitched(state));
}

TEST(LateralSwitch, NothingHappensBelowTheThresholdWithoutTheCondition) {
  const LateralModel model;
  const LateralConditions conditions;
  LateralState state = LateralState::Zero();
  state[Index::kSwitch] = kSwitchThreshold;
  EXPECT_EQ(integrate(model, conditions, state, {0.0, 0.1})[Index::kSwitch], kSwitchThreshold);
  state[Index::kSwitch] = 1.01 * kSwitchThreshold;
  EXPECT_NEAR(integrate(model, conditions, state, {0.0, 0.1})[Index::kSwitch], 1.01 * 0.05 + 0.1, 1e-12);
}

}  // namespace
