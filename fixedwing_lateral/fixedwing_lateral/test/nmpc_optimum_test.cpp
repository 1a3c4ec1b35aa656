// Where the real-time iteration comes to rest, against NLopt: an optimiser, a cost and a gradient that share nothing with it
// but the model's `integrate` and the path errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlopt.hpp>
#include <random>
#include <vector>

#include "step_oracles.hpp"

namespace {

using namespace polyfly;
using Index = LateralIndex;
using Eigen::Vector2d;

constexpr int kStates = 200;
constexpr int kIterations = 100;
// Tolerance of a move [rad], and relative tolerance of the cost.
constexpr double kAgreement = 1e-4;
constexpr double kDifference = 1e-6;

struct Problem {
  LateralModel model;
  LateralWeights weights;
  HorizonData data;
  LateralState state = LateralState::Zero();
  double previous = 0.0;
};

double stageCost(const Problem& problem, const LateralState& state) {
  const Vector2d velocity = groundVelocity(problem.data.conditions, state[Index::kHeading]);
  const TrackError error =
      trackError(closestPoint(problem.data.current, state.head<2>()).point, state.head<2>(), velocity);
  const LateralWeights& w = problem.weights;
  return w.track * error.track * error.track + w.course * error.course * error.course +
         w.roll * state[Index::kRoll] * state[Index::kRoll] +
         w.roll_rate * state[Index::kRollRate] * state[Index::kRollRate];
}

Eigen::Matrix<double, 6, 1> stageGradient(const Problem& problem, const LateralState& state) {
  Eigen::Matrix<double, 6, 1> gradient;
  for (int i = 0; i < 6; ++i) {
    LateralState more = state;
    LateralState less = state;
    more[i] += kDifference;
    less[i] -= kDifference;
    gradient[i] = (stageCost(problem, more) - stageCost(problem, less)) / (2.0 * kDifference);
  }
  return gradient;
}

/// Cost of the moves, and its gradient by an adjoint sweep.
double cost(const std::vector<double>& moves, std::vector<double>& gradient, void* context) {
  const Problem& problem = *static_cast<const Problem*>(context);
  const std::size_t count = moves.size();
  std::vector<LateralState> states{problem.state};
  std::vector<lateral_test::StepJacobian> jacobians;
  double sum = stageCost(problem, problem.state);
  for (std::size_t k = 0; k < count; ++k) {
    const double left = 1.0 - static_cast<double>(k) / static_cast<double>(count);
    const double slew = problem.weights.slew * left * left;
    const double deviation = moves[k] - problem.previous;
    sum += problem.weights.roll_reference * moves[k] * moves[k] + slew * deviation * deviation;
    const LateralStep step{moves[k], 0.1};
    if (!gradient.empty())
      jacobians.push_back(
          lateral_test::stepByDifferences(problem.model, problem.data.conditions, states.back(), step));
    states.push_back(integrate(problem.model, problem.data.conditions, states.back(), step));
    sum += stageCost(problem, states.back());
  }
  if (gradient.empty()) return sum;
  Eigen::Matrix<double, 6, 1> adjoint = stageGradient(problem, states[count]);
  for (std::size_t k = count; k-- > 0;) {
    const double left = 1.0 - static_cast<double>(k) / static_cast<double>(count);
    const double slew = problem.weights.slew * left * left;
    gradient[k] = jacobians[k].col(6).dot(adjoint) +
                  2.0 * (problem.weights.roll_reference * moves[k] + slew * (moves[k] - problem.previous));
    adjoint = (jacobians[k].leftCols<6>().transpose() * adjoint + stageGradient(problem, states[k])).eval();
  }
  return sum;
}

/// Within the course errors and distances from which a path is joined; the path goes on past the horizon.
Problem draw(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Problem problem;
  problem.data.conditions.airspeed = 14.0 + 3.0 * unit(random);
  problem.data.conditions.wind = {4.0 * unit(random), 4.0 * unit(random)};
  const bool circle = unit(random) < 0.0;
  const double bearing = kPi * unit(random);
  const double offset = 40.0 * unit(random);
  const double skew = 1.0 * unit(random);
  const Vector2d along(std::cos(bearing), std::sin(bearing));
  const Vector2d right(-along.y(), along.x());
  if (circle) {
    const double radius = 75.0 + 25.0 * unit(random);
    const TurnDirection direction = unit(random) < 0.0 ? TurnDirection::kLeft : TurnDirection::kRight;
    const double turn = direction == TurnDirection::kRight ? 1.0 : -1.0;
    problem.data.current = LoiterCircle{turn * radius * right, radius, direction};
  } else {
    problem.data.current = LineSegment{-500.0 * along, 500.0 * along};
  }
  problem.data.next = problem.data.current;
  problem.state.head<2>() = offset * right;
  problem.state[Index::kHeading] = bearing + skew;
  problem.state[Index::kRoll] = 0.3 * unit(random);
  problem.state[Index::kRollRate] = 0.3 * unit(random);
  problem.previous = problem.state[Index::kRoll];
  return problem;
}

TEST(RealTimeIteration, ComesToRestAtTheOptimumThatNloptFinds) {
  std::mt19937 random(2024);
  int bounded = 0;
  for (int i = 0; i < kStates; ++i) {
    Problem problem = draw(random);
    LateralNmpc nmpc(problem.model, HorizonOptions{}, "test");
    LateralLimits limits;
    if (i % 4 == 0) limits.roll_reference = 0.25;
    nmpc.setTuning(problem.weights, limits);
    nmpc.reset(problem.data, problem.state, problem.previous);
    const NmpcReport report = lateral_test::iterate(nmpc, problem.data, problem.state, kIterations, 1e-9);
    nlopt::opt reference(nlopt::LD_SLSQP, 40);
    reference.set_lower_bounds(-limits.roll_reference);
    reference.set_upper_bounds(limits.roll_reference);
    reference.set_min_objective(cost, &problem);
    reference.set_xtol_rel(1e-9);
    reference.set_ftol_rel(1e-13);
    reference.set_maxeval(400);
    const double start = std::clamp(problem.previous, -limits.roll_reference, limits.roll_reference);
    // The slew counts from the roll reference that `reset` could hold.
    problem.previous = start;
    std::vector<double> moves(40, start);
    double least = 0.0;
    try {
      reference.optimize(moves, least);
    } catch (const nlopt::roundoff_limited&) {  // at the optimum, to rounding
      std::vector<double> none;
      least = cost(moves, none, &problem);
    }
    EXPECT_NEAR(report.cost, least, kAgreement * least) << i;
    for (int k = 0; k < 40; ++k) EXPECT_NEAR(nmpc.moves()[k], moves[k], kAgreement) << i << ": " << k;
    bounded += report.active_bounds > 0 ? 1 : 0;
  }
  EXPECT_GT(bounded, 5);
}

}  // namespace
