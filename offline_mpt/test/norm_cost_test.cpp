// MPC with costs in the 1- and the infinity norm: every feasible parameter has an answer, it is optimal, and the map is
// proven. The oracle is GLPK, parameter by parameter.
#include <gtest/gtest.h>

#include "glpk_lp.hpp"
#include "norm_cost_programs.hpp"
#include "random.hpp"
#include "random_program.hpp"
#include "solved_map.hpp"

namespace polyfly {
namespace {

constexpr double kValue = 1e-7;
/// Distance from the edge of the feasible set at which GLPK's verdict is certain.
constexpr double kClear = 1e-6;

bool isFeasible(const ParametricProgram& program, const Eigen::VectorXd& bound) {
  return solveByGlpk(Eigen::VectorXd::Zero(program.variableCount()), program.A, bound).status == GLP_OPT;
}

/// Each parameter that is clearly feasible lies in a region, whose answer is optimal; none that is not does.
void expectRightAnswers(const ParametricProgram& program, const Partition& partition, int samples) {
  Random random(7);
  const int p = program.parameterCount();
  Eigen::VectorXd half(p);
  for (int j = 0; j < p; ++j) half(j) = program.parameters[static_cast<std::size_t>(j)].upper;
  int missing = 0, wrong = 0;
  for (int k = 0; k < samples; ++k) {
    const Eigen::VectorXd theta = random.matrix(p, 1).cwiseProduct(half);
    const Eigen::VectorXd bound = program.b + program.S * theta;
    const bool clear = isFeasible(program, bound.array() - kClear);
    if (!clear && isFeasible(program, bound.array() + kClear)) continue;
    const std::vector<CriticalRegion> held = holders(partition, theta);
    missing += held.empty() == clear;
    for (const CriticalRegion& region : held) {
      if (!clear) break;
      const double best = solveByGlpk(program.f, program.A, bound).objective;
      const Eigen::VectorXd z = region.K * theta + region.k;
      const bool optimal = std::abs(program.f.dot(z) - best) < kValue * (1.0 + best);
      wrong += !optimal || (program.A * z - bound).maxCoeff() > kValue;
    }
  }
  EXPECT_EQ(missing, 0) << program.name;
  EXPECT_EQ(wrong, 0) << program.name;
}

void expectRightAndProven(const ParametricProgram& program) {
  constexpr int kSamples = 40;
  ParametricProgram whole = program;
  outputAllVariables(whole);
  const Partition all = explore(whole);
  ASSERT_EQ(all.status, ExploreStatus::kComplete) << program.name;
  expectRightAnswers(whole, all, kSamples);
  const CertifyReport report = certified(program);
  EXPECT_TRUE(report.passed()) << program.name << "\n" << certifyText(report);
}

class NormCost : public ::testing::TestWithParam<CostNorm> {};

TEST_P(NormCost, OfADoubleIntegratorIsComplete) {
  for (const double period : {0.1, 0.2, 0.25, 0.3, 0.5, 1.0}) {
    for (const int horizon : {2, 3, 4}) {
      SCOPED_TRACE("period " + std::to_string(period));
      expectRightAndProven(normCostMpc(integrators(2, period), GetParam(), horizon));
    }
  }
}

TEST_P(NormCost, OfAnOscillatorIsComplete) {
  for (const double period : {0.1, 0.4}) expectRightAndProven(normCostMpc(oscillator(period), GetParam(), 3));
}

TEST_P(NormCost, OfATripleIntegratorIsComplete) {
  expectRightAndProven(normCostMpc(integrators(3, 0.5), GetParam(), 2));
}

INSTANTIATE_TEST_SUITE_P(Norms, NormCost, ::testing::Values(CostNorm::kOne, CostNorm::kInfinity));

}  // namespace
}  // namespace polyfly
