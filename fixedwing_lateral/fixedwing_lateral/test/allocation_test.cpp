// What runs in flight allocates nothing.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

#include "allocations.hpp"
#include "fixedwing_lateral/dubins.hpp"
#include "fixedwing_lateral/model.hpp"

namespace {

using namespace polyfly;
using polyfly_test::allocationCount;

TEST(Allocations, TheCounterCounts) {
  const long before = allocationCount();
  const auto number = std::make_unique<std::array<double, 100>>();
  const std::vector<double> numbers(100, 1.0);
  EXPECT_EQ(allocationCount() - before, 2) << number.get() << numbers.data();
}

TEST(Allocations, HorizonPathAndPlanNeedNone) {
  const LateralModel model;
  const std::array<PathSegment, 3> segments = {
      LineSegment{{0.0, 0.0}, {200.0, 0.0}},
      ArcSegment{{200.0, 60.0}, 60.0, TurnDirection::kRight, -kPi / 2.0, 2.0},
      LoiterCircle{{0.0, 0.0}, 60.0, TurnDirection::kLeft}};
  const long before = allocationCount();
  double sum = 0.0;
  for (const PathSegment& segment : segments) {
    LateralConditions conditions;
    conditions.gate = SwitchGate(segment);
    LateralState state = LateralState::Zero();
    for (int i = 0; i < 40; ++i) {
      state = integrate(model, conditions, state, {0.1, 0.1});
      const Eigen::Vector2d position = state.head<2>();
      const ClosestPoint nearest = closestPoint(segment, position);
      const Eigen::Vector2d velocity = groundVelocity(conditions, state[LateralIndex::kHeading]);
      sum += trackError(nearest.point, position, velocity).track;
    }
    const PathPose end{state.head<2>(), state[LateralIndex::kHeading]};
    sum += shortestDubinsPath(end, {{0.0, 0.0}, 0.0}, 60.0).length;
  }
  EXPECT_EQ(allocationCount() - before, 0);
  EXPECT_NE(sum, 0.0);
}

}  // namespace
