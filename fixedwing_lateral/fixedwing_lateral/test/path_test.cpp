// Nearest points and errors against sampling, signs against drawings, and the ends of segments.
#include "fixedwing_lateral/path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "polyfly_base/error.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;

constexpr double kExact = 1e-9;
constexpr TurnDirection kLeft = TurnDirection::kLeft;
constexpr TurnDirection kRight = TurnDirection::kRight;
const LineSegment kNorthward{{0.0, 0.0}, {100.0, 0.0}};

Vector2d polar(double radius, double bearing) {
  return radius * Vector2d(std::cos(bearing), std::sin(bearing));
}

TrackError errorAt(const PathSegment& segment, const Vector2d& position, const Vector2d& velocity) {
  return trackError(closestPoint(segment, position).point, position, velocity);
}

double trackAt(const PathSegment& segment, const Vector2d& position) {
  return errorAt(segment, position, {14.0, 0.0}).track;
}

TEST(Wrap, IsHalfOpen) {
  EXPECT_EQ(wrapCourse(kPi), -kPi);
  EXPECT_EQ(wrapCourse(-kPi), -kPi);
  EXPECT_EQ(wrapCourse(0.0), 0.0);
  EXPECT_EQ(wrapCourse(3.0 * kPi), -kPi);
  EXPECT_LT(wrapCourse(std::nextafter(kPi, 0.0)), kPi);
  EXPECT_GT(wrapCourse(std::nextafter(kPi, 0.0)), 3.0);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-60.0, 60.0);
  for (int i = 0; i < 1000; ++i) {
    const double angle = any(random);
    const double wrapped = wrapCourse(angle);
    EXPECT_GE(wrapped, -kPi);
    EXPECT_LT(wrapped, kPi);
    EXPECT_NEAR(std::sin(wrapped), std::sin(angle), kExact);
    EXPECT_NEAR(std::cos(wrapped), std::cos(angle), kExact);
  }
}

TEST(TrackError, IsPositiveToTheRightOfALine) {
  EXPECT_NEAR(trackAt(kNorthward, {50.0, 7.0}), 7.0, kExact);  // east of a line to the north
  EXPECT_NEAR(trackAt(kNorthward, {50.0, -7.0}), -7.0, kExact);
  const LineSegment westward{{0.0, 0.0}, {0.0, -100.0}};
  EXPECT_NEAR(trackAt(westward, {5.0, -50.0}), 5.0, kExact);
  EXPECT_NEAR(trackAt(westward, {-5.0, -50.0}), -5.0, kExact);
}

TEST(TrackError, IsPositiveInsideARightTurnAndOutsideALeftTurn) {
  for (const double bearing : {-3.0, -1.0, 0.0, 1.5, 3.0}) {
    const Vector2d centre(30.0, -40.0);
    const PathSegment right_arc = ArcSegment{centre, 60.0, kRight, bearing - 0.5, 1.0};
    const PathSegment left_arc = ArcSegment{centre, 60.0, kLeft, bearing + 0.5, 1.0};
    const PathSegment right_circle = LoiterCircle{centre, 60.0, kRight};
    const PathSegment left_circle = LoiterCircle{centre, 60.0, kLeft};
    for (const double radius : {50.0, 60.0, 75.0}) {
      const Vector2d position = centre + polar(radius, bearing);
      EXPECT_NEAR(trackAt(right_arc, position), 60.0 - radius, kExact);
      EXPECT_NEAR(trackAt(left_arc, position), radius - 60.0, kExact);
      EXPECT_NEAR(trackAt(right_circle, position), 60.0 - radius, kExact);
      EXPECT_NEAR(trackAt(left_circle, position), radius - 60.0, kExact);
    }
  }
}

TEST(CourseError, IsThePathsCourseLessTheAircrafts) {
  const Vector2d position(50.0, 0.0);
  EXPECT_NEAR(errorAt(kNorthward, position, polar(14.0, 0.3)).course, -0.3, kExact);
  EXPECT_NEAR(errorAt(kNorthward, position, polar(14.0, -0.3)).course, 0.3, kExact);
  EXPECT_NEAR(errorAt(LineSegment{{0.0, 0.0}, {0.0, 9.0}}, {0.0, 1.0}, {14.0, 0.0}).course, kPi / 2.0,
              kExact);
  // A right circle at its east goes south.
  EXPECT_NEAR(errorAt(LoiterCircle{{0.0, 0.0}, 60.0, kRight}, {0.0, 70.0}, {-14.0, 0.0}).course, 0.0, kExact);
  EXPECT_NEAR(errorAt(LoiterCircle{{0.0, 0.0}, 60.0, kLeft}, {0.0, 70.0}, {14.0, 0.0}).course, 0.0, kExact);
}

TEST(CourseError, WrapsAndStepsWhereTheCourseIsOpposite) {
  const LineSegment southward{{0.0, 0.0}, {-100.0, 0.0}};
  const Vector2d position(-50.0, 0.0);
  for (const double off : {-0.2, -1e-6, 1e-6, 0.2})  // either side of the jump of atan2 in the south
    EXPECT_NEAR(errorAt(southward, position, polar(14.0, kPi + off)).course, -off, kExact);
  EXPECT_NEAR(errorAt(kNorthward, {50.0, 0.0}, polar(14.0, kPi - 1e-6)).course, -kPi + 1e-6, kExact);
  EXPECT_NEAR(errorAt(kNorthward, {50.0, 0.0}, polar(14.0, kPi + 1e-6)).course, kPi - 1e-6, kExact);
  EXPECT_EQ(errorAt(kNorthward, {50.0, 0.0}, {-14.0, 0.0}).course, -kPi);  // exactly opposite: turn left
}

TEST(CourseError, IsZeroAndMarkedWithoutGroundSpeed) {
  for (const Vector2d& velocity :
       {Vector2d(0.0, 0.0), Vector2d(0.0, 0.9 * kLeastGroundSpeed), Vector2d(std::nan(""), 1.0)}) {
    const TrackError error = errorAt(kNorthward, {50.0, 7.0}, velocity);
    EXPECT_FALSE(error.course_defined);
    EXPECT_EQ(error.course, 0.0);
    EXPECT_NEAR(error.track, 7.0, kExact);
  }
  EXPECT_TRUE(errorAt(kNorthward, {50.0, 7.0}, {0.0, 1.1 * kLeastGroundSpeed}).course_defined);
}

TEST(ClosestPoint, OfALineStopsAtItsEndsAndTheTrackErrorDoesNot) {
  const ClosestPoint before = closestPoint(kNorthward, {-20.0, 5.0});
  EXPECT_EQ(before.foot, Foot::kBeforeStart);
  EXPECT_EQ(before.point.position, Vector2d(0.0, 0.0));
  EXPECT_EQ(before.remaining, 100.0);
  const ClosestPoint past = closestPoint(kNorthward, {120.0, 5.0});
  EXPECT_EQ(past.foot, Foot::kPastEnd);
  EXPECT_EQ(past.point.position, Vector2d(100.0, 0.0));
  EXPECT_EQ(past.remaining, 0.0);
  const ClosestPoint on = closestPoint(kNorthward, {30.0, 5.0});
  EXPECT_EQ(on.foot, Foot::kOnSegment);
  EXPECT_NEAR(on.remaining, 70.0, kExact);
  for (const double north : {-20.0, 30.0, 120.0}) EXPECT_NEAR(trackAt(kNorthward, {north, 5.0}), 5.0, kExact);
}

// A quarter turn to the right about (0, 0), from north to east.
TEST(ClosestPoint, OffAnArcIsTheNearerEndAndItsTangent) {
  const ArcSegment arc{{0.0, 0.0}, 60.0, kRight, 0.0, kPi / 2.0};
  const ClosestPoint past = closestPoint(arc, polar(50.0, kPi / 2.0 + 0.4));
  EXPECT_EQ(past.foot, Foot::kPastEnd);
  EXPECT_NEAR((past.point.position - Vector2d(0.0, 60.0)).norm(), 0.0, kExact);
  EXPECT_NEAR((past.point.tangent - Vector2d(-1.0, 0.0)).norm(), 0.0, kExact);
  EXPECT_EQ(past.remaining, 0.0);
  // The distance from the tangent, which is the line east = 60: the centre's side is the right.
  EXPECT_NEAR(trackAt(arc, {-30.0, 55.0}), 5.0, kExact);
  EXPECT_NEAR(trackAt(arc, {-30.0, 62.0}), -2.0, kExact);

  const ClosestPoint before = closestPoint(arc, polar(70.0, -0.3));
  EXPECT_EQ(before.foot, Foot::kBeforeStart);
  EXPECT_NEAR((before.point.position - Vector2d(60.0, 0.0)).norm(), 0.0, kExact);
  EXPECT_NEAR((before.point.tangent - Vector2d(0.0, 1.0)).norm(), 0.0, kExact);
  EXPECT_NEAR(before.remaining, 30.0 * kPi, kExact);

  const double middle = kPi / 4.0 + kPi;  // midway between the ends, on the far side
  EXPECT_EQ(closestPoint(arc, polar(60.0, middle - 1e-6)).foot, Foot::kPastEnd);
  EXPECT_EQ(closestPoint(arc, polar(60.0, middle + 1e-6)).foot, Foot::kBeforeStart);
}

TEST(ClosestPoint, TrackErrorIsContinuousAcrossTheEndsOfAnArc) {
  const double step = 1e-7;
  for (const TurnDirection direction : {kLeft, kRight}) {
    const double turn = direction == kRight ? 1.0 : -1.0;
    const ArcSegment arc{{5.0, 6.0}, 60.0, direction, 2.5, 2.0};
    for (const double end : {2.5, 2.5 + turn * 2.0}) {
      for (const double radius : {40.0, 60.0, 80.0}) {
        const double one = trackAt(arc, arc.centre + polar(radius, end - step));
        const double other = trackAt(arc, arc.centre + polar(radius, end + step));
        EXPECT_NEAR(one, other, 1e-4);
        EXPECT_NEAR(one, turn * (60.0 - radius), 1e-4);
      }
    }
  }
}

TEST(ClosestPoint, InTheCentreOfACircleHasAStandIn) {
  const ArcSegment arc{{5.0, 6.0}, 60.0, kLeft, 2.5, 2.0};
  const ClosestPoint on_arc = closestPoint(arc, arc.centre);
  EXPECT_NEAR((on_arc.point.position - arc.centre - polar(60.0, 2.5)).norm(), 0.0, kExact);
  EXPECT_EQ(on_arc.foot, Foot::kOnSegment);
  EXPECT_NEAR(trackAt(arc, arc.centre), -60.0, kExact);
  const LoiterCircle loiter{{5.0, 6.0}, 60.0, kRight};
  EXPECT_NEAR((closestPoint(loiter, loiter.centre).point.position - Vector2d(65.0, 6.0)).norm(), 0.0, kExact);
  EXPECT_NEAR(trackAt(loiter, loiter.centre), 60.0, kExact);
}

// The nearest of many points of the path, found with formulas of the test's own.
TEST(ClosestPoint, IsTheNearestOfAllSampledPoints) {
  std::mt19937 random(12);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  constexpr int kPoints = 4000;
  for (int i = 0; i < 300; ++i) {
    const Vector2d a(between(-200, 200), between(-200, 200));
    const Vector2d b(between(-200, 200), between(-200, 200));
    const Vector2d position(between(-300, 300), between(-300, 300));
    const double radius = between(20, 100);
    const double start = between(-7, 7);
    const double sweep = between(0.1, 2.0 * kPi - 0.01);
    const TurnDirection direction = i % 2 == 0 ? kLeft : kRight;
    const double turn = direction == kRight ? 1.0 : -1.0;
    double to_line = std::numeric_limits<double>::infinity();
    double to_arc = to_line;
    for (int k = 0; k <= kPoints; ++k) {
      const double part = static_cast<double>(k) / kPoints;
      to_line = std::min(to_line, (a + part * (b - a) - position).norm());
      to_arc = std::min(to_arc, (a + polar(radius, start + turn * part * sweep) - position).norm());
    }
    const PathSegment line = LineSegment{a, b};
    const PathSegment arc = ArcSegment{a, radius, direction, start, sweep};
    for (const auto& [segment, sampled] : {std::pair(line, to_line), std::pair(arc, to_arc)}) {
      const ClosestPoint nearest = closestPoint(segment, position);
      const double distance = (nearest.point.position - position).norm();
      EXPECT_LE(distance, sampled + kExact);
      EXPECT_GE(distance, sampled - length(segment) / kPoints);
      EXPECT_NEAR(nearest.point.tangent.norm(), 1.0, kExact);
      // The remaining length leads from the end back to the point.
      const PathPoint same = pointAt(segment, length(segment) - nearest.remaining);
      EXPECT_NEAR((same.position - nearest.point.position).norm(), 0.0, 1e-8);
      EXPECT_NEAR((same.tangent - nearest.point.tangent).norm(), 0.0, 1e-8);
      const double track = trackAt(segment, position);
      if (nearest.foot == Foot::kOnSegment)
        EXPECT_NEAR(std::abs(track), distance, 1e-8);
      else
        EXPECT_LE(std::abs(track), distance + kExact);
    }
  }
}

TEST(Segments, RunFromTheirEntranceInTheirDirection) {
  const ArcSegment left{{0.0, 0.0}, 10.0, kLeft, 0.5, 1.0};
  EXPECT_NEAR((pointAt(left, 0.0).position - polar(10.0, 0.5)).norm(), 0.0, kExact);
  EXPECT_NEAR((pointAt(left, 10.0).position - polar(10.0, -0.5)).norm(), 0.0, kExact);
  EXPECT_NEAR((pointAt(left, 99.0).position - polar(10.0, -0.5)).norm(), 0.0, kExact);  // limited
  EXPECT_NEAR((pointAt(left, -9.0).position - polar(10.0, 0.5)).norm(), 0.0, kExact);
  EXPECT_NEAR(length(left), 10.0, kExact);
  for (const PathSegment& segment :
       {PathSegment(kNorthward), PathSegment(left), PathSegment(LoiterCircle{{3.0, 4.0}, 60.0, kLeft})}) {
    // The tangent is the derivative of the position by the distance.
    for (double distance = 0.1; distance < 9.0; distance += 0.7) {
      const double step = 1e-5;
      const Vector2d change =
          pointAt(segment, distance + step).position - pointAt(segment, distance - step).position;
      EXPECT_NEAR((change / (2.0 * step) - pointAt(segment, distance).tangent).norm(), 0.0, 1e-7);
    }
  }
}

TEST(Segments, ALoiterHasNoEnd) {
  const PathSegment loiter = LoiterCircle{{0.0, 0.0}, 60.0, kRight};
  EXPECT_EQ(length(loiter), std::numeric_limits<double>::infinity());
  EXPECT_EQ(closestPoint(loiter, {1.0, 2.0}).remaining, std::numeric_limits<double>::infinity());
  for (int degrees = 0; degrees < 360; degrees += 15) {
    const ClosestPoint nearest = closestPoint(loiter, polar(80.0, degrees * kPi / 180.0));
    EXPECT_EQ(nearest.foot, Foot::kOnSegment);
    EXPECT_NEAR((nearest.point.position - polar(60.0, degrees * kPi / 180.0)).norm(), 0.0, kExact);
  }
  EXPECT_NEAR((pointAt(loiter, 0.0).position - pointAt(loiter, 240.0 * kPi).position).norm(), 0.0, 1e-8);
}

void expectRefused(const PathSegment& segment, const std::string& field) {
  try {
    checkSegment(segment, "segment 3");
    ADD_FAILURE() << field << " was taken";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find("segment 3: " + field + ": "), 0u) << error.what();
  }
}

TEST(Segments, AreRefusedWithTheFieldAndTheRule) {
  const double nan = std::nan("");
  const Vector2d zero = Vector2d::Zero();
  EXPECT_NO_THROW(checkSegment(kNorthward, ""));
  EXPECT_NO_THROW(checkSegment(ArcSegment{zero, 60.0, kLeft, 9.0, 6.28}, ""));
  EXPECT_NO_THROW(checkSegment(LoiterCircle{zero, 60.0, kLeft}, ""));
  expectRefused(LineSegment{{1.0, 2.0}, {1.0, 2.0}}, "b");
  expectRefused(LineSegment{{nan, 2.0}, {1.0, 2.0}}, "a");
  expectRefused(LineSegment{{1.0, 2.0}, {1.0, HUGE_VAL}}, "b");
  for (const double radius : {0.0, -60.0, nan, HUGE_VAL}) {
    expectRefused(ArcSegment{zero, radius, kLeft, 0.0, 1.0}, "radius");
    expectRefused(LoiterCircle{zero, radius, kLeft}, "radius");
  }
  for (const double sweep : {0.0, -1.0, 2.0 * kPi, nan, 1e-13})
    expectRefused(ArcSegment{zero, 60.0, kLeft, 0.0, sweep}, "sweep");
  expectRefused(ArcSegment{zero, 60.0, kLeft, nan, 1.0}, "start_bearing");
  expectRefused(ArcSegment{{0.0, nan}, 60.0, kLeft, 0.0, 1.0}, "centre");
  expectRefused(ArcSegment{zero, 60.0, static_cast<TurnDirection>(0), 0.0, 1.0}, "direction");
  expectRefused(LoiterCircle{{nan, 0.0}, 60.0, kLeft}, "centre");
  expectRefused(LoiterCircle{zero, 60.0, static_cast<TurnDirection>(5)}, "direction");
}

TEST(Carrier, GoesOnPastTheEnds) {
  const ArcSegment arc{{10.0, 20.0}, 50.0, kRight, 0.3, 1.0};
  const LoiterCircle circle{{10.0, 20.0}, 50.0, kRight};
  std::mt19937 random(17);
  std::uniform_real_distribution<double> any(-150.0, 150.0);
  for (int i = 0; i < 200; ++i) {
    const Vector2d position(any(random), any(random));
    const ClosestPoint onward = closestOnCarrier(arc, position);
    const ClosestPoint round = closestPoint(circle, position);
    EXPECT_LT((onward.point.position - round.point.position).norm(), kExact);
    EXPECT_LT((onward.point.tangent - round.point.tangent).norm(), kExact);
    EXPECT_NEAR(onward.curvature, 1.0 / 50.0, kExact);
    const ClosestPoint line = closestOnCarrier(kNorthward, position);
    EXPECT_LT((line.point.position - Vector2d(position.x(), 0.0)).norm(), kExact);
  }
  const ClosestPoint centre = closestOnCarrier(arc, {10.0, 20.0});
  EXPECT_LT((centre.point.position - pointAt(arc, 0.0).position).norm(), kExact);
}

}  // namespace
