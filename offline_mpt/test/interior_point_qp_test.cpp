#include "verify/interior_point_qp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "glpk_lp.hpp"
#include "random.hpp"

namespace polyfly {
namespace {

constexpr double kKktTolerance = 1e-8;
constexpr double kObjectiveTolerance = 1e-7;

// The KKT conditions written out anew, on the data as given.
void expectKkt(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::MatrixXd& A,
               const Eigen::VectorXd& b, const std::vector<int>& equalities,
               const InteriorPointSolution& solution) {
  const double scale = 1.0 + g.cwiseAbs().maxCoeff() + (H.size() ? H.cwiseAbs().maxCoeff() : 0.0);
  const Eigen::VectorXd stationarity = H * solution.z + g + A.transpose() * solution.lambda;
  EXPECT_LT(stationarity.cwiseAbs().maxCoeff() / scale, kKktTolerance);
  std::vector<bool> equality(static_cast<std::size_t>(A.rows()), false);
  for (const int i : equalities) equality[static_cast<std::size_t>(i)] = true;
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    const double slack = b[i] - A.row(i).dot(solution.z);
    const double row_scale = 1.0 + std::abs(b[i]) + A.row(i).norm();
    if (equality[static_cast<std::size_t>(i)]) {
      EXPECT_LT(std::abs(slack), kKktTolerance * row_scale);
      continue;
    }
    EXPECT_GT(slack, -kKktTolerance * row_scale);
    EXPECT_GT(solution.lambda[i], -kKktTolerance * scale);
    EXPECT_LT(std::abs(solution.lambda[i] * slack), kKktTolerance * scale * row_scale);
  }
}

void expectFarkas(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const std::vector<int>& equalities,
                  const Eigen::VectorXd& lambda) {
  const double value = -b.dot(lambda);
  EXPECT_GT(value, 0.0);
  EXPECT_LT((A.transpose() * lambda).cwiseAbs().maxCoeff(), 1e-5 * value);
  std::vector<bool> equality(static_cast<std::size_t>(A.rows()), false);
  for (const int i : equalities) equality[static_cast<std::size_t>(i)] = true;
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    if (!equality[static_cast<std::size_t>(i)]) {
      EXPECT_GE(lambda[i], 0.0);
    }
  }
}

TEST(InteriorPointQp, SolvesRandomStrictlyConvexPrograms) {
  Random random(1);
  int feasible = 0, infeasible = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const int n = 1 + random.below(12), m = 1 + random.below(30);
    const Eigen::MatrixXd L = random.matrix(n, n);
    const Eigen::MatrixXd H = L * L.transpose() + 0.01 * Eigen::MatrixXd::Identity(n, n);
    const Eigen::MatrixXd A = random.matrix(m, n);
    std::vector<int> equalities;
    for (int i = 0; i < std::min(m, n) / 3; ++i) equalities.push_back(2 * i);
    const Eigen::VectorXd g = 3.0 * random.matrix(n, 1);
    const Eigen::VectorXd b =
        A * random.matrix(n, 1) + random.matrix(m, 1).cwiseAbs() * random.uniform(-0.1, 1.0);
    InteriorPointQp qp(H, A, equalities);
    const InteriorPointSolution& solution = qp.solve(g, b);
    const LpAnswer lp = solveByGlpk(Eigen::VectorXd::Zero(n), A, b, equalities);
    if (lp.status == GLP_OPT) {
      ++feasible;
      ASSERT_EQ(solution.status, InteriorPointStatus::kOptimal)
          << toString(solution.status) << " trial " << trial << " residual " << solution.residual;
      expectKkt(H, g, A, b, equalities, solution);
    } else {
      ++infeasible;
      ASSERT_EQ(solution.status, InteriorPointStatus::kInfeasible)
          << toString(solution.status) << " trial " << trial << " residual " << solution.residual;
      expectFarkas(A, b, equalities, solution.lambda);
    }
  }
  EXPECT_GT(feasible, 100);
  EXPECT_GT(infeasible, 10);
}

TEST(InteriorPointQp, AgreesWithGlpkOnLinearPrograms) {
  Random random(2);
  int optimal = 0, infeasible = 0, unbounded = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const int n = 1 + random.below(10), m = n + random.below(25);
    const Eigen::MatrixXd A = random.matrix(m, n);
    std::vector<int> equalities;
    if (trial % 3 == 0 && n > 2) equalities = {0, 1};
    const Eigen::VectorXd g = random.matrix(n, 1);
    const Eigen::VectorXd b =
        A * random.matrix(n, 1) + random.matrix(m, 1).cwiseAbs() * random.uniform(-0.05, 1.0);
    const LpAnswer lp = solveByGlpk(g, A, b, equalities);
    InteriorPointQp qp(Eigen::MatrixXd::Zero(n, n), A, equalities);
    const InteriorPointSolution& solution = qp.solve(g, b);
    if (lp.status == GLP_OPT) {
      ++optimal;
      ASSERT_EQ(solution.status, InteriorPointStatus::kOptimal)
          << toString(solution.status) << " trial " << trial << " residual " << solution.residual;
      EXPECT_NEAR(solution.objective, lp.objective, kObjectiveTolerance * (1.0 + std::abs(lp.objective)));
    } else if (lp.status == GLP_NOFEAS) {
      ++infeasible;
      EXPECT_EQ(solution.status, InteriorPointStatus::kInfeasible)
          << toString(solution.status) << " trial " << trial;
    } else if (lp.status == GLP_UNBND) {
      ++unbounded;
      EXPECT_EQ(solution.status, InteriorPointStatus::kUnbounded)
          << toString(solution.status) << " trial " << trial;
    }
  }
  EXPECT_GT(optimal, 100);
  EXPECT_GT(infeasible, 10);
  EXPECT_GT(unbounded, 10);
}

// Vertices with far more active rows than variables, duplicated rows, and dependent equalities.
TEST(InteriorPointQp, SolvesDegeneratePrograms) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 2 + random.below(6), through = n + 1 + random.below(8);
    const Eigen::MatrixXd L = random.matrix(n, n);
    const Eigen::MatrixXd H = L * L.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd vertex = random.matrix(n, 1);
    Eigen::MatrixXd A(2 * through + 2, n);
    A.topRows(through) = random.matrix(through, n);
    A.middleRows(through, through) = 2.0 * A.topRows(through);
    A.row(2 * through) = random.matrix(1, n);
    A.row(2 * through + 1) = -3.0 * A.row(2 * through);
    const std::vector<int> equalities = {2 * through, 2 * through + 1};
    const Eigen::VectorXd b = A * vertex;
    // The cost pulls into the cone of the rows, so the vertex is the minimiser.
    const Eigen::VectorXd pull = A.topRows(through).transpose() * random.matrix(through, 1).cwiseAbs();
    const Eigen::VectorXd g = -H * vertex - pull;
    InteriorPointQp qp(H, A, equalities);
    const InteriorPointSolution& solution = qp.solve(g, b);
    ASSERT_EQ(solution.status, InteriorPointStatus::kOptimal)
        << "trial " << trial << " residual " << solution.residual;
    EXPECT_LT((solution.z - vertex).cwiseAbs().maxCoeff(), kKktTolerance);
    expectKkt(H, g, A, b, equalities, solution);
  }
}

// Multipliers that vanish exactly: strict complementarity fails, where an interior point loses half its
// digits.
TEST(InteriorPointQp, SolvesWithoutStrictComplementarity) {
  Random random(4);
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 2 + random.below(6), m = 1 + random.below(n);
    const Eigen::MatrixXd A = random.matrix(m, n);
    const Eigen::VectorXd minimiser = random.matrix(n, 1);
    const Eigen::VectorXd b = A * minimiser;
    InteriorPointQp qp(Eigen::MatrixXd::Identity(n, n), A);
    const InteriorPointSolution& solution = qp.solve(-minimiser, b);
    ASSERT_EQ(solution.status, InteriorPointStatus::kOptimal)
        << "trial " << trial << " residual " << solution.residual;
    EXPECT_LT((solution.z - minimiser).cwiseAbs().maxCoeff(), kKktTolerance);
  }
}

TEST(InteriorPointQp, SaysWhatIsInfeasible) {
  Eigen::MatrixXd A(2, 2);
  A << 1.0, 1.0, -1.0, -1.0;
  InteriorPointQp qp(Eigen::MatrixXd::Identity(2, 2), A);
  const Eigen::VectorXd b = Eigen::Vector2d(1.0, -2.0);
  ASSERT_EQ(qp.solve(Eigen::Vector2d::Zero(), b).status, InteriorPointStatus::kInfeasible);
  expectFarkas(A, b, {}, qp.solve(Eigen::Vector2d::Zero(), b).lambda);
  EXPECT_EQ(qp.solve(Eigen::Vector2d::Zero(), Eigen::Vector2d(2.0, -1.0)).status,
            InteriorPointStatus::kOptimal);

  InteriorPointQp contradiction(Eigen::MatrixXd::Identity(2, 2), A, {0, 1});
  ASSERT_EQ(contradiction.solve(Eigen::Vector2d::Zero(), b).status, InteriorPointStatus::kInfeasible);
  expectFarkas(A, b, {0, 1}, contradiction.solve(Eigen::Vector2d::Zero(), b).lambda);
  EXPECT_EQ(contradiction.solve(Eigen::Vector2d::Zero(), Eigen::Vector2d(1.0, -1.0)).status,
            InteriorPointStatus::kOptimal);
}

TEST(InteriorPointQp, SolvesWithoutRowsAndWithoutFreedom) {
  InteriorPointQp free(2.0 * Eigen::MatrixXd::Identity(3, 3), Eigen::MatrixXd(0, 3));
  const InteriorPointSolution& unconstrained =
      free.solve(Eigen::Vector3d(2.0, -4.0, 0.0), Eigen::VectorXd(0));
  ASSERT_EQ(unconstrained.status, InteriorPointStatus::kOptimal);
  EXPECT_LT((unconstrained.z - Eigen::Vector3d(-1.0, 2.0, 0.0)).norm(), kKktTolerance);

  InteriorPointQp pinned(Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Identity(2, 2), {0, 1});
  const InteriorPointSolution& point = pinned.solve(Eigen::Vector2d(1.0, 1.0), Eigen::Vector2d(3.0, 4.0));
  ASSERT_EQ(point.status, InteriorPointStatus::kOptimal);
  EXPECT_LT((point.z - Eigen::Vector2d(3.0, 4.0)).norm(), kKktTolerance);
}

TEST(InteriorPointQp, GivesTheSameAnswerWhateverWasSolvedBefore) {
  Random random(5);
  const Eigen::MatrixXd A = random.matrix(12, 5);
  InteriorPointQp used(Eigen::MatrixXd::Identity(5, 5), A);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::VectorXd g = random.matrix(5, 1), b = random.matrix(12, 1);
    InteriorPointQp fresh(Eigen::MatrixXd::Identity(5, 5), A);
    const InteriorPointSolution expected = fresh.solve(g, b);
    const InteriorPointSolution& again = used.solve(g, b);
    EXPECT_EQ(again.status, expected.status);
    if (expected.status == InteriorPointStatus::kOptimal) {
      EXPECT_EQ(again.z, expected.z);
    }
  }
}

}  // namespace
}  // namespace polyfly
