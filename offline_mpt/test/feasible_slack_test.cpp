// How far inside the feasible set a parameter lies, against GLPK.
#include "program/feasible_slack.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "glpk_lp.hpp"
#include "random_program.hpp"

namespace polyfly {
namespace {

// max s: a_i z / |a_i| + s <= (S (t, 1))_i / |a_i|
double slackByGlpk(const NormalisedProgram& program, const Eigen::VectorXd& t) {
  Eigen::VectorXd t1(t.size() + 1);
  t1 << t, 1.0;
  const Eigen::VectorXd length = program.A.rowwise().norm();
  Eigen::MatrixXd A(program.m, program.n + 1);
  A << length.cwiseInverse().asDiagonal() * program.A, Eigen::VectorXd::Ones(program.m);
  Eigen::VectorXd cost = Eigen::VectorXd::Zero(program.n + 1);
  cost(program.n) = -1.0;
  const LpAnswer answer = solveByGlpk(cost, A, (program.S * t1).cwiseQuotient(length));
  if (answer.status == GLP_UNBND) return std::numeric_limits<double>::infinity();
  EXPECT_EQ(answer.status, GLP_OPT);
  return -answer.objective;
}

TEST(FeasibleSlack, IsThatOfGlpk) {
  int infeasible = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    ParametricProgram program = randomProgram(2 + static_cast<int>(seed % 4), 14, 3, seed);
    program.S *= 4.0;  // so that the box reaches beyond the feasible set
    const NormalisedProgram scaled = normalise(program);
    const Eigen::VectorXd t = Eigen::VectorXd::Random(3);
    const std::optional<double> slack = feasibleSlack(scaled, t);
    ASSERT_TRUE(slack.has_value());
    const double expected = slackByGlpk(scaled, t);
    if (std::isinf(expected)) {  // ours ends at a far box
      EXPECT_GT(*slack, 100.0);
      continue;
    }
    EXPECT_NEAR(*slack, expected, 1e-9 * (1.0 + std::abs(expected)));
    infeasible += expected < 0.0 ? 1 : 0;
  }
  EXPECT_GT(infeasible, 3);
  EXPECT_LT(infeasible, 37);
}

TEST(FeasibleSlack, SaysWhenItCannotTell) {
  const NormalisedProgram scaled = normalise(randomProgram(PolytopeSolver::kMaxDimension + 1, 20, 2, 1));
  EXPECT_FALSE(feasibleSlack(scaled, Eigen::VectorXd::Zero(2)).has_value());
}

}  // namespace
}  // namespace polyfly
