// A path that is neither line nor circle: nearest point, tangent, curvature and length against sampling, and
// flown.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "fixedwing_lateral/spline_path.hpp"
#include "fixedwing_plant/flight_metrics.hpp"
#include "polyfly_base/error.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;

const std::vector<Vector2d> kPoints = {{0.0, 0.0},     {150.0, 30.0},  {300.0, 0.0},
                                       {420.0, 100.0}, {350.0, 260.0}, {180.0, 300.0}};

std::vector<PathPoint> sampled(const SplinePath& path, int count) {
  std::vector<PathPoint> points;
  for (int i = 0; i <= count; ++i) points.push_back(path.pointAt(path.length() * i / count));
  return points;
}

TEST(SplinePath, GoesThroughItsPointsAtItsLength) {
  const SplinePath path(kPoints, "test");
  for (const Vector2d& point : kPoints) EXPECT_LT((path.closest(point).point.position - point).norm(), 1e-6);
  const std::vector<PathPoint> points = sampled(path, 20000);
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector2d step = points[i].position - points[i - 1].position;
    EXPECT_NEAR(step.norm(), path.length() / 20000, 1e-4 * step.norm());  // equal steps
    EXPECT_GT(points[i].tangent.dot(step.normalized()), 1.0 - 1e-6);
    length += step.norm();
  }
  EXPECT_NEAR(length, path.length(), 1e-3);
}

TEST(SplinePath, FindsTheNearestPoint) {
  const SplinePath path(kPoints, "test");
  const std::vector<PathPoint> points = sampled(path, 20000);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-100.0, 500.0);
  for (int i = 0; i < 300; ++i) {
    const Vector2d position(any(random), any(random));
    double least = std::numeric_limits<double>::infinity();
    for (const PathPoint& point : points) least = std::min(least, (point.position - position).norm());
    const ClosestPoint nearest = path.closest(position);
    EXPECT_NEAR((nearest.point.position - position).norm(), least, 1e-3);
    EXPECT_LT((path.pointAt(path.length() - nearest.remaining).position - nearest.point.position).norm(),
              1e-6);
  }
}

TEST(SplinePath, HasTheCurvatureOfItsTangent) {
  const SplinePath path(kPoints, "test");
  constexpr double kStep = 1e-3;
  for (double distance = 5.0; distance < path.length() - 5.0; distance += 7.3) {
    const PathPoint before = path.pointAt(distance - kStep);
    const PathPoint after = path.pointAt(distance + kStep);
    const double turn = wrapCourse(std::atan2(after.tangent.y(), after.tangent.x()) -
                                   std::atan2(before.tangent.y(), before.tangent.x()));
    EXPECT_NEAR(path.closest(path.pointAt(distance).position).curvature, turn / (2.0 * kStep), 1e-5);
  }
}

TEST(SplinePath, EndsLikeASegment) {
  const SplinePath path(kPoints, "test");
  const PathPoint end = path.pointAt(path.length());
  const ClosestPoint past = path.closest(end.position + 20.0 * end.tangent);
  EXPECT_EQ(past.foot, Foot::kPastEnd);
  EXPECT_EQ(past.curvature, 0.0);
  EXPECT_NEAR(past.remaining, 0.0, 1e-9);
  const PathPoint start = path.pointAt(0.0);
  EXPECT_EQ(path.closest(start.position - 5.0 * start.tangent).foot, Foot::kBeforeStart);
  EXPECT_THROW(SplinePath({{0.0, 0.0}}, "test"), Error);
  EXPECT_THROW(SplinePath({{0.0, 0.0}, {0.0, 0.0}}, "test"), Error);
  EXPECT_THROW(SplinePath({{0.0, 0.0}, {std::nan(""), 1.0}}, "test"), Error);
  EXPECT_THROW(checkSegment(CurveSegment{}, "test"), Error);
}

TEST(SplinePath, IsFlownToItsLoiter) {
  const SplinePath path(kPoints, "test");
  const Mission mission = makeMission({CurveSegment{&path}}, {70.0, TurnDirection::kLeft}, "test");
  GuidanceOptions options;
  LateralGuidance guidance(options, "test");
  guidance.setMission(mission);
  AircraftState start;
  start.position = {0.0, 10.0};
  start.ground_velocity = {14.0, 0.0};
  ChapterAircraft aircraft(LateralModel{}, start, 14.0, {2.0, -3.0});
  Sensors sensors({}, 1);
  const auto samples = flyLaw(aircraft, sensors, lawOf(guidance), options.period, 120.0);
  EXPECT_TRUE(samples.back().output.loitering);
  double late = 0.0;
  for (const FlightSample& sample : samples)
    if (sample.time > 12.0) late = std::max(late, pathDistance(mission.segments, sample));
  EXPECT_LT(late, 3.0);
}

}  // namespace
