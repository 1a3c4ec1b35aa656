// Multiparametric linear programs: optimal value against GLPK, and the rule that picks one of several optima.
#include <gtest/gtest.h>

#include <random>

#include "glpk_lp.hpp"
#include "random_program.hpp"
#include "solved_map.hpp"

namespace polyfly {
namespace {

constexpr double kValue = 1e-7;

/// H = 0, z in a box besides its random rows, and the whole of z as the answer.
ParametricProgram linearProgram(int n, int m, int p, unsigned seed, bool cost_moves) {
  ParametricProgram program = randomProgram(n, m + 2 * n, p, seed);
  program.H.setZero();
  if (!cost_moves) program.F.setZero();
  program.A.bottomRows(2 * n) << Eigen::MatrixXd::Identity(n, n), -Eigen::MatrixXd::Identity(n, n);
  program.b.tail(2 * n).setConstant(2.0);
  program.S.bottomRows(2 * n).setZero();
  outputAllVariables(program);
  return program;
}

class LinearProgram : public ::testing::TestWithParam<bool> {};

TEST_P(LinearProgram, EveryParameterHasAnOptimum) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const int p = 1 + static_cast<int>(seed % 3);
    const ParametricProgram program = linearProgram(2 + seed % 4, 6, p, seed, GetParam());
    const Partition partition = explore(program);
    ASSERT_EQ(partition.status, ExploreStatus::kComplete) << program.name;
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int k = 0; k < 300; ++k) {
      const Eigen::VectorXd theta = Eigen::VectorXd::NullaryExpr(p, [&] { return uniform(random); });
      const LpAnswer truth =
          solveByGlpk(program.f + program.F * theta, program.A, program.b + program.S * theta);
      const std::vector<CriticalRegion> held = holders(partition, theta);
      EXPECT_EQ(held.empty(), truth.status != GLP_OPT) << program.name << " sample " << k;
      for (const CriticalRegion& region : held) {
        const Eigen::VectorXd z = region.K * theta + region.k;
        EXPECT_NEAR((program.f + program.F * theta).dot(z), truth.objective,
                    kValue * (1.0 + std::abs(truth.objective)));
        EXPECT_LT((program.A * z - program.b - program.S * theta).maxCoeff(), kValue);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cost, LinearProgram, ::testing::Values(false, true));

// min -z_0 over |z_i| <= 1 + theta: z_1 is free, and the shortest optimum has z_1 = 0.
TEST(LinearProgramRule, OfSeveralOptimaTheShortestIsTaken) {
  ParametricProgram program = linearProgram(2, 1, 1, 1, false);
  program.f << -1.0, 0.0;
  program.A.row(0).setZero();  // says nothing
  program.S.row(0).setZero();
  program.b.tail(4).setConstant(1.5);
  program.S.bottomRows(4).setConstant(1.0);
  const Partition partition = explore(program);
  ASSERT_EQ(partition.status, ExploreStatus::kComplete);
  ASSERT_EQ(partition.regions.size(), 1u);
  const Eigen::VectorXd z =
      partition.regions[0].K * Eigen::VectorXd::Constant(1, 0.25) + partition.regions[0].k;
  EXPECT_NEAR(z(0), 1.75, 1e-12);
  EXPECT_NEAR(z(1), 0.0, 1e-12);
}

}  // namespace
}  // namespace polyfly
