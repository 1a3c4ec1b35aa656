// The terminal set against flights of the closed loop: inside, all bounds hold for ever; just outside, one breaks.
#include "polytope_sets/terminal_set.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <random>
#include <string>

#include "error_of.hpp"
#include "holds.hpp"

namespace polyfly {
namespace {

constexpr int kSteps = 400;
constexpr double kTolerance = 1e-7;

std::string cartText(const std::string& more, double reference) {
  return R"(polyfly_problem: 1
name: cart
type: tracking_mpc
model:
  states:
    - {name: p, unit: m}
    - {name: v, unit: m/s, range: [-1, 1.5]}
  inputs:
    - {name: a, unit: m/s^2, range: [-1, 1.5]}
  A: [[0, 1], [0, -0.1]]
  B: [[0], [1]]
  C: [[1, 0]]
sampling_time: 0.2
horizon: 4
weights:
  Q: [4, 1]
  R: [[0.5]]
)" + more +
         R"(parameters:
  - {name: e_p, role: error, of: p, unit: m, range: [-3, 3]}
  - {name: e_v, role: error, of: v, unit: m/s, range: [-2, 2]}
  - {name: a_ref, role: input_reference, of: a, unit: m/s^2, range: [-)" +
         std::to_string(reference) + ", " + std::to_string(reference) + "]}\n";
}

/// Gain of the limit of the Riccati recursion.
Eigen::MatrixXd gainOf(const MpcProblem& problem, const DiscreteModel& model) {
  Eigen::MatrixXd P = problem.Q, K;
  for (int k = 0; k < 5000; ++k) {
    K = (problem.R + model.B.transpose() * P * model.B).inverse() * model.B.transpose() * P * model.A;
    P = (problem.Q + model.A.transpose() * P * (model.A - model.B * K)).eval();
  }
  return K;
}

/// Greatest violation of any bound on the way of the closed loop from e, for the references at the ends of their range.
double violation(const MpcProblem& problem, double reference, Eigen::VectorXd e) {
  const DiscreteModel model = discretise(problem, problem.sampling_time);
  const Eigen::MatrixXd K = gainOf(problem, model);
  double worst = -1.0;
  const auto check = [&](double value, double lower, double upper) {
    worst = std::max({worst, value - upper, lower - value});
  };
  for (int k = 0; k < kSteps; ++k) {
    const double u = -(K * e)(0);
    for (const double u_ref : {-reference, reference}) {
      check(u + u_ref, problem.inputs[0].lower, problem.inputs[0].upper);
      for (const StageConstraint& constraint : problem.constraints) {
        if (constraint.soft) continue;
        check(constraint.G_x.dot(e) + constraint.G_u(0) * (u + (constraint.absolute ? u_ref : 0.0)),
              constraint.signal.lower, constraint.signal.upper);
      }
    }
    check(e(1), problem.states[1].lower, problem.states[1].upper);
    check(e(0), -3.0, 3.0);
    check(e(1), -2.0, 2.0);
    e = ((model.A - model.B * K) * e).eval();
  }
  return worst;
}

TEST(TerminalSets, AreTheLargestInWhichAllBoundsHoldForEver) {
  const std::string row =
      "constraints:\n  - {name: mixed, of: {p: 0.5, a: 1}, unit: m, range: [-1.2, 1.1], "
      "measured_from: reference}\n  - {of: v, upper: 0.1, measured_from: reference, soft: "
      "{linear: 1, quadratic: 1}}\n";
  for (const std::string& more : {std::string(), row}) {
    constexpr double kReference = 0.3;
    const MpcProblem problem = parseProblem(cartText(more, kReference), "cart.yaml");
    const TerminalSet set = terminalSet(problem);
    ASSERT_GE(set.T.rows(), 4);
    std::mt19937 generator(3);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector2d direction(normal(generator), normal(generator));
      const double reach = (set.T * direction).cwiseQuotient(set.t).maxCoeff();
      ASSERT_GT(reach, 0.0);
      const Eigen::VectorXd edge = direction / reach;
      EXPECT_LE(violation(problem, kReference, edge), kTolerance);
      EXPECT_GT(violation(problem, kReference, 1.0001 * edge), 0.0);
    }
  }
}

TEST(TerminalSets, OfAProblemWithoutRoomForTheReferenceAreRefused) {
  const MpcProblem problem = parseProblem(cartText("", 1.0), "cart.yaml");
  EXPECT_TRUE(holds(errorOf([&] { terminalSet(problem); }),
                    "cart.yaml: terminal set: a: a reference in its range reaches the bound"));
}

}  // namespace
}  // namespace polyfly
