// Multiparametric linear programs: optimal value against GLPK, and the rule that picks one of several optima.
#include <glpk.h>
#include <gtest/gtest.h>

#include <random>

#include "offline_mpt/explore.hpp"
#include "random_program.hpp"

namespace polyfly {
namespace {

constexpr double kInside = 1e-9;
constexpr double kValue = 1e-7;

/// Optimal value of the program at theta; false where infeasible.
bool glpkValue(const ParametricProgram& program, const Eigen::VectorXd& theta, double& value) {
  const Eigen::VectorXd cost = program.f + program.F * theta;
  const Eigen::VectorXd bound = program.b + program.S * theta;
  glp_term_out(GLP_OFF);
  glp_prob* lp = glp_create_prob();
  glp_add_rows(lp, program.rowCount());
  glp_add_cols(lp, program.variableCount());
  for (int j = 0; j < program.variableCount(); ++j) {
    glp_set_col_bnds(lp, j + 1, GLP_FR, 0.0, 0.0);
    glp_set_obj_coef(lp, j + 1, cost(j));
  }
  for (int i = 0; i < program.rowCount(); ++i) {
    std::vector<int> index{0};
    std::vector<double> entries{0.0};
    for (int j = 0; j < program.variableCount(); ++j) {
      index.push_back(j + 1);
      entries.push_back(program.A(i, j));
    }
    glp_set_mat_row(lp, i + 1, program.variableCount(), index.data(), entries.data());
    glp_set_row_bnds(lp, i + 1, GLP_UP, 0.0, bound(i));
  }
  glp_simplex(lp, nullptr);
  const bool optimal = glp_get_status(lp) == GLP_OPT;
  value = glp_get_obj_val(lp);
  glp_delete_prob(lp);
  return optimal;
}

/// H = 0, z in a box besides its random rows, and the whole of z as the answer.
ParametricProgram linearProgram(int n, int m, int p, unsigned seed, bool cost_moves) {
  ParametricProgram program = randomProgram(n, m + 2 * n, p, seed);
  program.H.setZero();
  if (!cost_moves) program.F.setZero();
  program.A.bottomRows(2 * n) << Eigen::MatrixXd::Identity(n, n), -Eigen::MatrixXd::Identity(n, n);
  program.b.tail(2 * n).setConstant(2.0);
  program.S.bottomRows(2 * n).setZero();
  program.inputs.assign(n, program.inputs.front());
  for (int i = 0; i < n; ++i) program.inputs[i].name = "z_" + std::to_string(i);
  program.E = Eigen::MatrixXd::Identity(n, n);
  program.C = Eigen::MatrixXd::Zero(n, p);
  program.c = Eigen::VectorXd::Zero(n);
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
      double expected = 0.0;
      const bool feasible = glpkValue(program, theta, expected);
      bool held = false;
      for (const CriticalRegion& region : partition.regions) {
        if ((region.G * theta - region.g).maxCoeff() > kInside) continue;
        held = true;
        const Eigen::VectorXd z = region.K * theta + region.k;
        EXPECT_NEAR((program.f + program.F * theta).dot(z), expected, kValue * (1.0 + std::abs(expected)));
        EXPECT_LT((program.A * z - program.b - program.S * theta).maxCoeff(), kValue);
      }
      EXPECT_EQ(held, feasible) << program.name << " sample " << k;
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
