// The reduced program, in floating point and in fractions, against Eq. 34 as printed, solved by GLPK.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "../../test/glpk_lp.hpp"
#include "../../test/random.hpp"
#include "full_program.hpp"
#include "made_robust.hpp"
#include "robust_mpc/online_lp.hpp"

namespace polyfly {
namespace {

constexpr double kGlpk = 2e-7;  // GLPK's own tolerance on rows, with room for its effect on the optimum

struct Sample {
  Eigen::VectorXd theta;
  RationalVector exact;
};

Sample sampleOf(const RobustProblem& problem, Random& random, double share) {
  Sample sample;
  sample.theta.resize(problem.parameterCount());
  for (int j = 0; j < problem.parameterCount(); ++j) {
    const Signal& signal = problem.parameters[static_cast<std::size_t>(j)].signal;
    sample.theta[j] = share * random.uniform(signal.lower, signal.upper);
    sample.exact.emplace_back(sample.theta[j]);
  }
  return sample;
}

void compare(const MadeRobust& made, int samples, int exact_samples, std::uint64_t seed) {
  const RobustProblem problem = made.problem();
  const FullProgram full = buildFullProgram(problem);
  OnlineLp online(problem);
  Random random(seed);
  int feasible = 0;
  for (int k = 0; k < samples; ++k) {
    const Sample sample = sampleOf(problem, random, k % 3 == 0 ? 0.1 : 1.0);
    const Eigen::VectorXd right = full.b + full.S * sample.theta;
    const LpAnswer glpk = solveByGlpk(full.c, full.A, right);
    const OnlineLp::Answer answer = online.solve(sample.theta);
    ASSERT_EQ(answer.feasible, glpk.status == GLP_OPT) << made.text() << sample.theta.transpose();
    if (!answer.feasible) continue;
    ++feasible;
    ASSERT_NEAR(answer.peak, glpk.objective, kGlpk) << made.text() << sample.theta.transpose();
    // the first move reaches the optimum in the full program too
    Eigen::MatrixXd fixed(full.A.rows() + 1, full.A.cols());
    fixed << full.A, Eigen::RowVectorXd::Unit(full.A.cols(), full.first_input);
    Eigen::VectorXd fixed_right(right.size() + 1);
    fixed_right << right, answer.input;
    const LpAnswer held = solveByGlpk(full.c, fixed, fixed_right, {static_cast<int>(right.size())});
    ASSERT_EQ(held.status, GLP_OPT);
    ASSERT_NEAR(held.objective, answer.peak, kGlpk);
    if (feasible > exact_samples) continue;
    const OnlineLp::ExactAnswer exact = online.solveExactly(sample.exact);
    ASSERT_TRUE(exact.feasible);
    EXPECT_NEAR(exact.peak.get_d(), answer.peak, 1e-9);
    EXPECT_NEAR(exact.input.get_d(), answer.input, 1e-6);
  }
  EXPECT_GT(feasible, samples / 4);
}

TEST(RobustLp, EqualsEq34) {
  MadeRobust made;
  for (const char* stack : {"paper", "shift"}) {
    for (const int states : {2, 3, 4}) {
      made.stack = stack;
      made.states = states;
      made.horizon = states == 3 ? 5 : 4;
      compare(made, 20, 4, 11);
    }
  }
}

TEST(RobustLp, EqualsEq34WithFixedFeedback) {
  MadeRobust made;
  made.horizon = 4;
  for (const char* feedback : {"zero", "fixed"}) {
    for (const char* stack : {"paper", "shift"}) {
      made.feedback = feedback;
      made.stack = stack;
      compare(made, 15, 3, 12);
    }
  }
}

TEST(RobustLp, EqualsEq34WithTwoChannelsSeveralOutputsAndReferences) {
  MadeRobust made;
  made.horizon = 4;
  made.torque = true;
  compare(made, 15, 3, 13);
  made.outputs = "[[1, 0, 0], [0, 0.5, 0], [0.2, 0, 1.5]]";
  compare(made, 15, 3, 14);
  made.references = true;
  made.stack = "shift";
  made.floor = "0.05";
  compare(made, 15, 3, 15);
}

TEST(RobustLp, EqualsEq34WithInvariance) {
  MadeRobust made;
  made.bounded_position = true;
  made.horizon = 4;
  made.invariance =
      "first_step";  // with the terminal rule GLPK does not end well on Eq. 34; robust_law_test has it
  for (const char* stack : {"paper", "shift"}) {
    made.stack = stack;
    compare(made, 10, 2, 16);
  }
}

TEST(RobustLp, TheChaptersHorizon) {
  MadeRobust made;
  compare(made, 6, 3, 17);
}

}  // namespace
}  // namespace polyfly
