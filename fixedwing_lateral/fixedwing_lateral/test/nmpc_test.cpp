// The real-time iteration: one Gauss-Newton step against reference solutions and against a dense program
// built from `integrate` and differences; the optimum against NLopt is in nmpc_optimum_test.cpp.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "allocations.hpp"
#include "fixedwing_lateral/lateral_nmpc.hpp"
#include "fixedwing_lateral/tracking_cost.hpp"
#include "polyfly_base/error.hpp"
#include "reference_qps.hpp"
#include "step_oracles.hpp"

namespace {

using namespace polyfly;
using namespace lateral_test;
using Index = LateralIndex;
using Eigen::Vector2d;

// Tolerance of a move against its reference [rad].
constexpr double kStepAgreement = 1e-6;
// Rounding of a difference of positions.
constexpr double kDerivative = 1e-10;

LateralWeights hardWeights() {
  LateralWeights weights;
  weights.track = 1.0;
  weights.course = 30.0;
  weights.roll_reference = 1.0;
  weights.slew = 1.0;
  return weights;
}

void expectReferenceSteps(const std::string& set, const LateralWeights& weights) {
  const std::vector<ReferenceQp> references = lateral_test::readReferenceQps(set);
  if (references.empty()) GTEST_SKIP() << "no reference data (POLYFLY_DATA): " << set;
  LateralNmpc nmpc(LateralModel{}, HorizonOptions{}, "test");
  nmpc.setTuning(weights, LateralLimits{});
  int number = 0;
  for (const ReferenceQp& reference : references) {
    std::copy(reference.moves.begin(), reference.moves.end(), nmpc.moves());
    std::copy(reference.nodes.begin(), reference.nodes.end(), nmpc.nodes());
    std::copy(reference.previous.begin(), reference.previous.end(), nmpc.previousMoves());
    ASSERT_TRUE(nmpc.prepare(reference.data));
    const NmpcReport report = nmpc.feedback(reference.state);
    EXPECT_EQ(report.status, QpStatus::kOptimal);
    for (int k = 0; k < 40; ++k)
      EXPECT_NEAR(nmpc.program().moves()[k], reference.solution[k], kStepAgreement)
          << set << number << ": " << k;
    ++number;
  }
}

TEST(RealTimeIteration, IsTheReferenceStepOnRandomStates) { expectReferenceSteps("fw_rand", {}); }
TEST(RealTimeIteration, IsTheReferenceStepAlongALoop) { expectReferenceSteps("fw_seq", {}); }
TEST(RealTimeIteration, IsTheReferenceStepWithManyBounds) { expectReferenceSteps("fw_hard", hardWeights()); }

/// Seeded states about a line and a circle, some in reach of the gate between them.
struct Scene {
  HorizonData data;
  LateralState state = LateralState::Zero();
};

Scene drawScene(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Scene scene;
  scene.data.conditions.airspeed = 14.0 + 3.0 * unit(random);
  scene.data.conditions.wind = {4.0 * unit(random), 4.0 * unit(random)};
  scene.data.conditions.roll_bias = 0.05 * unit(random);
  scene.data.conditions.turn_gain = 1.0 + 0.2 * unit(random);
  scene.data.conditions.turn_bias = 0.03 * unit(random);
  scene.data.current = LineSegment{{0.0, 0.0}, {150.0, 20.0 * unit(random)}};
  scene.data.next = LoiterCircle{{180.0, 60.0 + 10.0 * unit(random)}, 60.0, TurnDirection::kRight};
  if (unit(random) < 0.0) std::swap(scene.data.current, scene.data.next);
  if (std::holds_alternative<LoiterCircle>(scene.data.current)) {
    const LoiterCircle circle = std::get<LoiterCircle>(scene.data.current);
    scene.data.current =
        ArcSegment{circle.centre, circle.radius, TurnDirection::kLeft, 3.0 * unit(random), 4.0};
  }
  scene.data.conditions.gate = SwitchGate(scene.data.current);
  Eigen::Index k = 0;
  for (const double size : {80.0, 30.0, 0.4, 1.2, 0.4}) scene.state[k++] = size * unit(random);
  scene.state[0] += 60.0;
  scene.state[5] = 0.0;
  return scene;
}

TEST(Shooting, IsTheStepOfTheModel) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const LateralModel model;
  const RollShooting shooting(model, 0.1);
  const int order[5] = {Index::kNorth, Index::kEast, Index::kHeading, Index::kRoll, Index::kRollRate};
  for (int i = 0; i < 500; ++i) {
    Scene scene = drawScene(random);
    scene.state[Index::kSwitch] = unit(random) < 0.0 ? 0.0 : 0.06 * unit(random);
    const double u = 0.6 * unit(random);
    const LateralStep step{u, 0.1};
    const LateralState end = integrate(model, scene.data.conditions, scene.state, step);
    const StepJacobian exact = stepByDifferences(model, scene.data.conditions, scene.state, step);
    HorizonStage stage;
    const ShootingResult shot = shooting.shoot(scene.data.conditions, scene.state, u, stage);
    for (int row = 0; row < 5; ++row) EXPECT_NEAR(shot.end[row], end[order[row]], 1e-12);
    EXPECT_NEAR(shot.switch_rise, end[Index::kSwitch] - scene.state[Index::kSwitch], 1e-15);
    for (int row = 0; row < 5; ++row) {
      for (int column = 0; column < 5; ++column)
        EXPECT_NEAR(stage.A(row, column), exact(order[row], order[column]), kDerivative);
      EXPECT_NEAR(stage.B(row), exact(order[row], Index::kSize), kDerivative);
    }
  }
}

/// The cost of a stage, phi counted from `roll`.
double stageCost(const TrackingCost& tracking, const LateralWeights& weights, const LateralState& state,
                 double roll) {
  HorizonStage unused;
  return tracking.linearise(state, unused).cost + weights.roll * std::pow(state[Index::kRoll] - roll, 2);
}

TEST(TrackingCost, HasTheGradientOfItsCost) {
  std::mt19937 random(5);
  const LateralWeights weights;
  constexpr double kDifference = 1e-5;
  const int order[5] = {Index::kNorth, Index::kEast, Index::kHeading, Index::kRoll, Index::kRollRate};
  int switched = 0;
  for (int i = 0; i < 300; ++i) {
    const Scene scene = drawScene(random);
    const TrackingCost tracking(scene.data, weights);
    HorizonStage stage;
    const double roll = scene.state[Index::kRoll];
    tracking.linearise(scene.state, stage);
    stage.q[3] = weights.roll * (roll - 0.1);
    const PathSegment* here = &tracking.segmentOf(scene.state);
    switched += here == &scene.data.next ? 1 : 0;
    for (int row = 0; row < 5; ++row) {
      LateralState more = scene.state;
      LateralState less = scene.state;
      more[order[row]] += kDifference;
      less[order[row]] -= kDifference;
      if (&tracking.segmentOf(more) != here || &tracking.segmentOf(less) != here) continue;
      const double slope =
          (stageCost(tracking, weights, more, 0.1) - stageCost(tracking, weights, less, 0.1)) /
          (2.0 * kDifference);
      if (std::abs(slope) > 1e4) continue;  // across the half turn of the course error
      EXPECT_NEAR(2.0 * stage.q[row], slope, 1e-4 * (1.0 + std::abs(slope))) << i << ": " << row;
    }
  }
  EXPECT_GT(switched, 10);
}

TEST(TrackErrorJacobian, LimitsTheCourseNearACentre) {
  const PathSegment circle = LoiterCircle{{0.0, 0.0}, 50.0, TurnDirection::kRight};
  TrackErrorJacobian by;
  trackError(closestPoint(circle, {1e-3, 0.0}), {1e-3, 0.0}, {14.0, 0.0}, by);
  // The limit is the value at a tenth of the radius.
  EXPECT_NEAR(by.course_by_position.norm(), 1.0 / 5.0, 1e-9);
  trackError(closestPoint(circle, {25.0, 0.0}), {25.0, 0.0}, {14.0, 0.0}, by);
  EXPECT_NEAR(by.course_by_position.norm(), 1.0 / 25.0, 1e-9);
  trackError(closestPoint(circle, {25.0, 0.0}), {25.0, 0.0}, {0.0, 0.0}, by);
  EXPECT_EQ(by.course_by_velocity.norm(), 0.0);
}

/// The cost of moves flown through `integrate`, for differences.
double costOfMoves(const LateralNmpc& nmpc, const Scene& scene, const LateralWeights& weights,
                   const Eigen::VectorXd& moves, const double* previous) {
  const TrackingCost tracking(scene.data, weights);
  LateralState state = scene.state;
  double cost = 0.0;
  const int count = static_cast<int>(moves.size());
  for (int k = 0; k <= count; ++k) {
    cost += stageCost(tracking, weights, state, 0.0);
    if (k == count) break;
    const double left = 1.0 - static_cast<double>(k) / count;
    const double deviation = moves[k] - previous[k];
    cost += weights.roll_reference * moves[k] * moves[k] + weights.slew * left * left * deviation * deviation;
    state = integrate(nmpc.model(), scene.data.conditions, state, {moves[k], nmpc.stepDuration()});
  }
  return cost;
}

TEST(RealTimeIteration, MeasuresTheGradientOfTheCost) {
  std::mt19937 random(9);
  const LateralWeights weights;
  for (int i = 0; i < 20; ++i) {
    const Scene scene = drawScene(random);
    LateralNmpc nmpc(LateralModel{}, HorizonOptions{}, "test");
    nmpc.reset(scene.data, scene.state, 0.1);
    const Eigen::VectorXd moves = Eigen::VectorXd::Constant(40, 0.1);
    double largest = 0.0;
    for (int k = 0; k < 40; ++k) {
      Eigen::VectorXd more = moves;
      Eigen::VectorXd less = moves;
      more[k] += 1e-6;
      less[k] -= 1e-6;
      const double slope = (costOfMoves(nmpc, scene, weights, more, nmpc.previousMoves()) -
                            costOfMoves(nmpc, scene, weights, less, nmpc.previousMoves())) /
                           4e-6;  // half of the gradient
      largest = std::max(largest, std::abs(slope));
    }
    ASSERT_TRUE(nmpc.prepare(scene.data));
    const NmpcReport report = nmpc.feedback(scene.state);
    EXPECT_NEAR(report.kkt, largest, 1e-4 * (1.0 + largest)) << i;
    EXPECT_NEAR(report.cost, costOfMoves(nmpc, scene, weights, moves, nmpc.previousMoves()),
                1e-7 * report.cost);
  }
}

TEST(RealTimeIteration, ComesToRestWithMoreIterations) {
  std::mt19937 random(21);
  for (int i = 0; i < 10; ++i) {
    Scene scene = drawScene(random);
    scene.data.conditions.gate = SwitchGate();
    LateralNmpc nmpc(LateralModel{}, HorizonOptions{}, "test");
    nmpc.reset(scene.data, scene.state, 0.0);
    const IterationReport one = iterate(nmpc, scene.data, scene.state, 1, 1e-6);
    EXPECT_EQ(one.iterations, 1);
    const IterationReport many = iterate(nmpc, scene.data, scene.state, 200, 1e-6);
    EXPECT_LT(many.kkt, 1e-6);
    EXPECT_LT(many.iterations, 200);
    const IterationReport rest = iterate(nmpc, scene.data, scene.state, 200, 1e-5);
    EXPECT_LE(rest.iterations, 1);
  }
}

TEST(RealTimeIteration, ForgetsWholeTurnsOfTheHeading) {
  std::mt19937 random(23);
  const Scene scene = drawScene(random);
  LateralNmpc nmpc(LateralModel{}, HorizonOptions{}, "test");
  LateralNmpc turned(LateralModel{}, HorizonOptions{}, "test");
  nmpc.reset(scene.data, scene.state, 0.0);
  turned.reset(scene.data, scene.state, 0.0);
  LateralState state = scene.state;
  state[Index::kHeading] += 6.0 * kPi;
  iterate(nmpc, scene.data, scene.state, 1, 0.0);
  iterate(turned, scene.data, state, 1, 0.0);
  for (int k = 0; k < 40; ++k) EXPECT_NEAR(nmpc.moves()[k], turned.moves()[k], 1e-9);
}

TEST(RealTimeIteration, RefusesWhatIsNotFiniteAndKeepsItsNodes) {
  std::mt19937 random(25);
  const Scene scene = drawScene(random);
  LateralNmpc nmpc(LateralModel{}, HorizonOptions{}, "test");
  nmpc.reset(scene.data, scene.state, 0.0);
  iterate(nmpc, scene.data, scene.state, 3, 0.0);
  const std::vector<double> moves(nmpc.moves(), nmpc.moves() + 40);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (int row = 0; row < 5; ++row) {
    LateralState bad = scene.state;
    bad[row] = row % 2 == 0 ? kNan : std::numeric_limits<double>::infinity();
    EXPECT_EQ(iterate(nmpc, scene.data, bad, 1, 0.0).status, QpStatus::kNotFinite) << row;
    for (int k = 0; k < 40; ++k) EXPECT_EQ(nmpc.moves()[k], moves[k]);
  }
  HorizonData windy = scene.data;
  windy.conditions.wind.x() = kNan;
  EXPECT_FALSE(nmpc.prepare(windy));
  EXPECT_EQ(nmpc.feedback(scene.state).status, QpStatus::kNotFinite);
  EXPECT_EQ(iterate(nmpc, scene.data, scene.state, 1, 0.0).status, QpStatus::kOptimal);
}

TEST(RealTimeIteration, HoldsTheRollBoundOrExceedsItLeast) {
  std::mt19937 random(27);
  LateralLimits limits;
  limits.roll = 0.3;
  for (int i = 0; i < 20; ++i) {
    Scene scene = drawScene(random);
    scene.state[Index::kRoll] = i % 2 == 0 ? 0.0 : 0.5;
    scene.state[Index::kRollRate] = 0.0;
    LateralNmpc nmpc(LateralModel{}, HorizonOptions{}, "test");
    nmpc.setTuning(LateralWeights{}, limits);
    nmpc.reset(scene.data, scene.state, 0.0);
    const NmpcReport report = iterate(nmpc, scene.data, scene.state, 3, 0.0);
    EXPECT_EQ(report.status, QpStatus::kOptimal);
    double latest = 0.0;
    for (int k = 1; k <= 40; ++k) {
      if (std::abs(nmpc.nodes()[k][Index::kRoll]) > limits.roll + 1e-9) latest = 0.1 * k;
    }
    EXPECT_LE(latest, i % 2 == 0 ? 0.0 : 0.4);  // it rolls back as fast as its moves allow
  }
}

TEST(RealTimeIteration, AllocatesNothing) {
  std::mt19937 random(29);
  const Scene scene = drawScene(random);
  LateralNmpc nmpc(LateralModel{}, HorizonOptions{}, "test");
  nmpc.reset(scene.data, scene.state, 0.0);
  LateralLimits tight;
  tight.roll = 0.2;
  tight.roll_reference = 0.3;
  const long before = polyfly_test::allocationCount();
  iterate(nmpc, scene.data, scene.state, 5, 0.0);
  nmpc.setTuning(hardWeights(), tight);
  nmpc.keepAsPrevious(0.5);
  iterate(nmpc, scene.data, scene.state, 5, 0.0);
  nmpc.reset(scene.data, scene.state, 0.0);
  EXPECT_EQ(polyfly_test::allocationCount(), before);
}

TEST(RealTimeIteration, ReadsThePreviousHorizonLater) {
  LateralNmpc nmpc(LateralModel{}, HorizonOptions{}, "test");
  for (int k = 0; k < 40; ++k) nmpc.moves()[k] = 0.01 * k;
  nmpc.keepAsPrevious(0.0);
  EXPECT_EQ(nmpc.previousMoves()[7], nmpc.moves()[7]);
  nmpc.keepAsPrevious(0.5);
  EXPECT_NEAR(nmpc.previousMoves()[0], 0.005, 1e-15);
  EXPECT_NEAR(nmpc.previousMoves()[39], 0.39, 1e-15);
  nmpc.keepAsPrevious(1.0);
  EXPECT_EQ(nmpc.previousMoves()[0], nmpc.moves()[1]);
}

TEST(Options, OutOfRangeAreRefused) {
  EXPECT_THROW(LateralNmpc(LateralModel{}, HorizonOptions{1, 0.1}, "here"), Error);
  EXPECT_THROW(LateralNmpc(LateralModel{}, HorizonOptions{40, 0.0}, "here"), Error);
  LateralModel model;
  model.a0 = -1.0;
  EXPECT_THROW(LateralNmpc(model, HorizonOptions{}, "here"), Error);
  LateralWeights weights;
  weights.slew = -1.0;
  try {
    checkTuning(weights, LateralLimits{}, "here");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("here: weights/slew: must lie in"), std::string::npos);
  }
  weights = {};
  LateralLimits limits;
  limits.roll = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(checkTuning(weights, limits, "here"), Error);
}

}  // namespace
