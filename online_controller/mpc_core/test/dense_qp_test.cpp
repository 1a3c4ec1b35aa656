// The active-set QP by its optimality conditions, which need no other solver.
#include "mpc_core/dense_qp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kResidual = 1e-9;

struct Qp {
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
  Eigen::MatrixXd A;
  Eigen::VectorXd b;
  std::vector<int> equalities;
};

Eigen::MatrixXd gaussian(int rows, int columns, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

/// Random and feasible: b leaves room at a random point.
Qp randomQp(int n, int m, int equalities, std::mt19937_64& random) {
  Qp qp;
  const Eigen::MatrixXd root = gaussian(n, n, random);
  qp.H = root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
  qp.g = 5.0 * gaussian(n, 1, random);
  qp.A = gaussian(m, n, random);
  qp.b = qp.A * gaussian(n, 1, random);
  qp.b.tail(m - equalities) += gaussian(m - equalities, 1, random).cwiseAbs();
  for (int k = 0; k < equalities; ++k) qp.equalities.push_back(k);
  return qp;
}

/// Greatest violation of stationarity, feasibility, sign and complementarity.
double kktResidual(const Qp& qp, const DenseQp& solver) {
  const Eigen::VectorXd& z = solver.z();
  const Eigen::VectorXd& lambda = solver.lambda();
  const Eigen::VectorXd slack = qp.b - qp.A * z;
  double residual = (qp.H * z + qp.g + qp.A.transpose() * lambda).cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < slack.size(); ++i) {
    const bool equality = std::find(qp.equalities.begin(), qp.equalities.end(), i) != qp.equalities.end();
    residual = std::max(residual, equality ? std::abs(slack(i)) : std::max(-slack(i), -lambda(i)));
    residual = std::max(residual, std::abs(slack(i) * lambda(i)));
  }
  return residual;
}

TEST(DenseQp, SolvesRandomProgramsToTheirOptimalityConditions) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 300; ++round) {
    const int n = 1 + round % 25;
    const Qp qp = randomQp(n, 2 * n + round % 7, std::min(round % 3, n - 1), random);
    DenseQp solver(qp.H, qp.A, qp.equalities);
    ASSERT_EQ(solver.solve(qp.g.data(), qp.b.data()), QpStatus::kOptimal) << "round " << round;
    EXPECT_LT(kktResidual(qp, solver), kResidual * (1.0 + qp.g.norm())) << "round " << round;
  }
}

TEST(DenseQp, WarmStartGivesTheSameMinimiser) {
  std::mt19937_64 random(8);
  for (int round = 0; round < 60; ++round) {
    Qp qp = randomQp(12, 40, 0, random);
    DenseQp warm(qp.H, qp.A);
    for (int step = 0; step < 10; ++step) {
      qp.g += 0.3 * gaussian(12, 1, random);
      qp.b += 0.02 * gaussian(40, 1, random).cwiseAbs();
      DenseQp cold(qp.H, qp.A);
      ASSERT_EQ(cold.solve(qp.g.data(), qp.b.data()), QpStatus::kOptimal);
      ASSERT_EQ(warm.solve(qp.g.data(), qp.b.data(), true), QpStatus::kOptimal);
      EXPECT_LT((warm.z() - cold.z()).cwiseAbs().maxCoeff(), 1e-9);
      EXPECT_LT(kktResidual(qp, warm), kResidual * (1.0 + qp.g.norm()));
    }
  }
}

TEST(DenseQp, WarmStartRecoversAfterAnInfeasibleCall) {
  Eigen::MatrixXd A(2, 1);
  A << 1.0, -1.0;
  DenseQp solver(Eigen::MatrixXd::Identity(1, 1), A);
  const double g = -3.0;
  const double contradictory[2] = {-1.0, -1.0};
  const double open[2] = {2.0, 2.0};
  EXPECT_EQ(solver.solve(&g, contradictory), QpStatus::kInfeasible);
  ASSERT_EQ(solver.solve(&g, open, true), QpStatus::kOptimal);
  EXPECT_NEAR(solver.z()(0), 2.0, 1e-12);
}

TEST(DenseQp, TellsContradictionFromTouching) {
  std::mt19937_64 random(9);
  for (int round = 0; round < 100; ++round) {
    const int n = 2 + round % 10;
    Qp qp = randomQp(n, 3 * n, 0, random);
    // a pair of opposite rows: apart by `gap`, touching or overlapping
    const Eigen::RowVectorXd a = gaussian(1, n, random);
    const double gap = round % 2 == 0 ? 1e-3 : -1e-3;
    qp.A.conservativeResize(3 * n + 2, n);
    qp.b.conservativeResize(3 * n + 2);
    // The other rows leave room.
    qp.b.head(3 * n).array() += 100.0;
    qp.A.row(3 * n) = a;
    qp.A.row(3 * n + 1) = -a;
    qp.b(3 * n) = 0.3;
    qp.b(3 * n + 1) = -0.3 - gap;
    DenseQp solver(qp.H, qp.A);
    EXPECT_EQ(solver.solve(qp.g.data(), qp.b.data()), gap > 0.0 ? QpStatus::kInfeasible : QpStatus::kOptimal);
    if (gap <= 0.0) {
      EXPECT_LT(kktResidual(qp, solver), 1e-7 * (1.0 + qp.g.norm()));
    }
  }
}

TEST(DenseQp, DuplicateAndZeroRowsDoNoHarm) {
  std::mt19937_64 random(10);
  for (int round = 0; round < 60; ++round) {
    Qp qp = randomQp(6, 12, 0, random);
    qp.A.conservativeResize(26, 6);
    qp.b.conservativeResize(26);
    qp.A.middleRows(12, 12) = 3.0 * qp.A.topRows(12);
    qp.b.segment(12, 12) = 3.0 * qp.b.head(12);
    qp.A.bottomRows(2).setZero();
    qp.b.tail(2) << 0.0, 1.0;
    DenseQp solver(qp.H, qp.A);
    ASSERT_EQ(solver.solve(qp.g.data(), qp.b.data()), QpStatus::kOptimal);
    EXPECT_LT(kktResidual(qp, solver), kResidual * (1.0 + qp.g.norm()));
    qp.b(24) = -1e-3;
    EXPECT_EQ(solver.solve(qp.g.data(), qp.b.data()), QpStatus::kInfeasible);
  }
}

TEST(DenseQp, EqualitiesMayPullEitherWay) {
  Eigen::MatrixXd A(1, 2);
  A << 1.0, 1.0;
  DenseQp solver(Eigen::MatrixXd::Identity(2, 2), A, {0});
  const double g[2] = {0.0, 0.0};
  for (const double level : {-2.0, 0.0, 3.0}) {
    ASSERT_EQ(solver.solve(g, &level), QpStatus::kOptimal);
    EXPECT_NEAR(solver.z()(0), level / 2.0, 1e-14);
    EXPECT_NEAR(solver.z()(1), level / 2.0, 1e-14);
  }
}

TEST(DenseQp, RefusesNanAndBadSizes) {
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(2, 2);
  DenseQp solver(identity, identity);
  const double bad[2] = {std::nan(""), 0.0};
  const double good[2] = {1.0, 1.0};
  EXPECT_EQ(solver.solve(bad, good), QpStatus::kNotFinite);
  EXPECT_EQ(solver.solve(good, bad), QpStatus::kNotFinite);
  EXPECT_EQ(solver.solve(good, good), QpStatus::kOptimal);
  EXPECT_THROW(DenseQp(-identity, identity), Error);
  EXPECT_THROW(DenseQp(identity, Eigen::MatrixXd::Identity(3, 3)), Error);
}

}  // namespace
}  // namespace polyfly
