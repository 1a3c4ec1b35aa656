// The solver of the check of answers, on programs whose solution is made first and against GLPK.
#include "verify/strict_qp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "glpk_lp.hpp"
#include "made_program.hpp"
#include "random.hpp"

namespace polyfly {
namespace {

constexpr double kPrecision = 1e-12;
constexpr double kNear = 1e-10;

using Verdict = StrictAnswer::Verdict;

/// min 1/2 z'Hz + g'z, A z <= b, all of z for output. Its parameter has no effect.
ParametricProgram programOf(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::MatrixXd& A,
                            const Eigen::VectorXd& b, std::vector<int> equalities = {}) {
  ParametricProgram program = madeProgram(1, {static_cast<int>(H.rows()), static_cast<int>(A.rows()), 1});
  program.H = H;
  program.f = g;
  program.F.setZero();
  program.A = A;
  program.b = b;
  program.S.setZero();
  program.equalities = std::move(equalities);
  return program;
}

StrictAnswer solved(const ParametricProgram& program, Convexity convexity = Convexity::kAsGiven) {
  StrictQp qp(program, convexity);
  EXPECT_TRUE(qp.definite());
  return qp.solve(Eigen::VectorXd::Zero(1), kPrecision);
}

Eigen::MatrixXd definite(Random& random, int n) {
  const Eigen::MatrixXd L = random.matrix(n, n);
  return L * L.transpose() + 0.01 * Eigen::MatrixXd::Identity(n, n);
}

TEST(StrictQp, FindsMadeSolutions) {
  Random random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const int n = 1 + random.below(12), m = 1 + random.below(30);
    const Eigen::MatrixXd H = definite(random, n), A = random.matrix(m, n);
    const Eigen::VectorXd z = random.matrix(n, 1);
    Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(m), slack = random.matrix(m, 1).cwiseAbs();
    std::vector<int> equalities;
    for (int k = 0; k < n / 2; ++k) {
      const int row = random.below(m);
      slack[row] = 0.0;
      multipliers[row] = random.uniform(0.0, 2.0);
      if (k % 3 == 0) equalities.push_back(row);
    }
    std::sort(equalities.begin(), equalities.end());
    equalities.erase(std::unique(equalities.begin(), equalities.end()), equalities.end());
    for (const int row : equalities) multipliers[row] -= 1.0;
    const StrictAnswer answer =
        solved(programOf(H, -H * z - A.transpose() * multipliers, A, A * z + slack, equalities));
    ASSERT_EQ(answer.verdict, Verdict::kOptimal) << "trial " << trial;
    EXPECT_LT((answer.u - z).cwiseAbs().maxCoeff(), kNear) << "trial " << trial;
  }
}

// Vertices with far more active rows than variables, duplicated rows, and dependent equalities.
TEST(StrictQp, FindsDegenerateVertices) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 2 + random.below(6), through = n + 1 + random.below(8);
    const Eigen::MatrixXd H = definite(random, n);
    Eigen::MatrixXd A(2 * through, n);
    A.topRows(through) = random.matrix(through, n);
    A.bottomRows(through) = 2.0 * A.topRows(through);
    const Eigen::VectorXd pull = A.topRows(through).transpose() * random.matrix(through, 1).cwiseAbs();
    const StrictAnswer answer = solved(programOf(H, -pull, A, Eigen::VectorXd::Zero(2 * through)));
    ASSERT_EQ(answer.verdict, Verdict::kOptimal) << "trial " << trial;
    EXPECT_LT(answer.u.cwiseAbs().maxCoeff(), kNear) << "trial " << trial;
  }
}

TEST(StrictQp, AgreesWithGlpkOnWhatIsFeasible) {
  Random random(2);
  int feasible = 0, infeasible = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const int n = 1 + random.below(10), m = 1 + random.below(30);
    const Eigen::MatrixXd A = random.matrix(m, n);
    std::vector<int> equalities;
    for (int i = 0; i < std::min(m, n) / 3; ++i) equalities.push_back(2 * i);
    const Eigen::VectorXd b =
        A * random.matrix(n, 1) + random.matrix(m, 1).cwiseAbs() * random.uniform(-0.1, 1.0);
    const LpAnswer lp = solveByGlpk(Eigen::VectorXd::Zero(n), A, b, equalities);
    (lp.status == GLP_OPT ? feasible : infeasible) += 1;
    const Verdict expected = lp.status == GLP_OPT ? Verdict::kOptimal : Verdict::kInfeasible;
    const ParametricProgram program =
        programOf(definite(random, n), 3.0 * random.matrix(n, 1), A, b, equalities);
    EXPECT_EQ(solved(program).verdict, expected) << "trial " << trial;
    EXPECT_EQ(solved(program, Convexity::kFeasibility).verdict, expected) << "trial " << trial;
  }
  EXPECT_GT(feasible, 100);
  EXPECT_GT(infeasible, 10);
}

TEST(StrictQp, AgreesWithGlpkOnLinearCosts) {
  Random random(4);
  int optimal = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const int n = 1 + random.below(10), m = n + random.below(25);
    const Eigen::MatrixXd A = random.matrix(m, n);
    const Eigen::VectorXd g = random.matrix(n, 1);
    const Eigen::VectorXd b = A * random.matrix(n, 1) + random.matrix(m, 1).cwiseAbs();
    const LpAnswer lp = solveByGlpk(g, A, b, {});
    if (lp.status != GLP_OPT) continue;
    ++optimal;
    const StrictAnswer answer = solved(programOf(Eigen::MatrixXd::Zero(n, n), g, A, b), Convexity::kShortest);
    ASSERT_EQ(answer.verdict, Verdict::kOptimal) << "trial " << trial;
    EXPECT_NEAR(g.dot(answer.u), lp.objective, 1e-7 * (1.0 + std::abs(lp.objective))) << "trial " << trial;
  }
  EXPECT_GT(optimal, 100);
}

// What is asked of u is then less than rounding, or nothing.
TEST(StrictQp, EndsWhereOutputsHaveNoSize) {
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const int n = 2 + random.below(6), m = 2 * n;
    ParametricProgram program = programOf(definite(random, n), 9.0 * random.matrix(n, 1), random.matrix(m, n),
                                          random.matrix(m, 1).cwiseAbs());
    ParametricProgram contradictory = program;
    contradictory.A.row(1) = -program.A.row(0);
    contradictory.b[0] = -1.0;  // and -b[1] is greater
    for (const double size : {1.0, 0.0}) {
      program.E *= size;
      contradictory.E *= size;
      const auto verdict = [](const ParametricProgram& of) {
        return StrictQp(of, Convexity::kAsGiven).solve(Eigen::VectorXd::Zero(1), 1e-35).verdict;
      };
      EXPECT_EQ(verdict(program), Verdict::kOptimal) << "trial " << trial;
      EXPECT_EQ(verdict(contradictory), Verdict::kInfeasible) << "trial " << trial;
    }
  }
}

// One equality leaves one direction free.
TEST(StrictQp, ALinearCostIsNotDefiniteWhereAnEqualityHolds) {
  const ParametricProgram program = programOf(Eigen::Matrix2d::Zero(), Eigen::Vector2d(1.0, 2.0),
                                              Eigen::RowVector2d(0.3, -0.7), Eigen::VectorXd::Ones(1), {0});
  EXPECT_FALSE(StrictQp(program, Convexity::kAsGiven).definite());
}

TEST(StrictQp, SaysThatOppositeRowsContradictEachOther) {
  Eigen::MatrixXd A(2, 2);
  A << 1.0, 1.0, -1.0, -1.0;
  const Eigen::MatrixXd H = Eigen::Matrix2d::Identity();
  for (const std::vector<int>& equalities : {std::vector<int>(), std::vector<int>({0, 1})}) {
    const auto verdict = [&](double upper, double lower) {
      return solved(programOf(H, Eigen::Vector2d::Zero(), A, Eigen::Vector2d(upper, -lower), equalities))
          .verdict;
    };
    EXPECT_EQ(verdict(1.0, 2.0), Verdict::kInfeasible);
    EXPECT_EQ(verdict(1.0, 1.0), Verdict::kOptimal);
  }
}

}  // namespace
}  // namespace polyfly
