// The bounded QP by its optimality conditions, by enumeration of every active set of small problems, and
// against solutions computed elsewhere in extended precision.
#include "mpc_core/bounded_qp.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "allocations.hpp"
#include "random_matrices.hpp"
#include "support.hpp"

namespace polyfly {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Qp {
  Eigen::MatrixXd H;
  Eigen::VectorXd g, lower, upper;
  Eigen::MatrixXd A;
  Eigen::VectorXd row_lower, row_upper;
  Eigen::VectorXd penalty;

  int n() const { return static_cast<int>(H.rows()); }
  int m() const { return static_cast<int>(A.rows()); }
  QpVectors vectors() const {
    return {g.data(), lower.data(), upper.data(), row_lower.data(), row_upper.data()};
  }
};

BoundedQp solverFor(const Qp& qp, bool constant = false) {
  BoundedQp solver(qp.n(), qp.m());
  EXPECT_TRUE(constant ? solver.setConstantHessian(qp.H.data()) : solver.setHessian(qp.H.data()));
  solver.setRows(qp.A.data());
  for (int i = 0; i < qp.m(); ++i) solver.setPenalty(i, qp.penalty(i));
  return solver;
}

/// Feasible at a random point of the box; `tightness` is the share of the unconstrained minimiser's length
/// that the box leaves.
Qp randomQp(int n, int m, double tightness, std::mt19937_64& random) {
  Qp qp;
  qp.H = positiveDefinite(n, random);
  const Eigen::VectorXd centre = gaussian(n, 1, random);
  qp.g = -qp.H * centre;
  qp.lower = -tightness * gaussian(n, 1, random).cwiseAbs();
  qp.upper = tightness * gaussian(n, 1, random).cwiseAbs();
  qp.A = gaussian(m, n, random);
  const Eigen::VectorXd at = qp.A * (0.5 * (qp.lower + qp.upper));
  qp.row_lower = at - tightness * gaussian(m, 1, random).cwiseAbs();
  qp.row_upper = at + tightness * gaussian(m, 1, random).cwiseAbs();
  qp.penalty = Eigen::VectorXd::Constant(m, kInfinity);
  return qp;
}

/// Violation of one constraint's conditions: value in [lower, upper] unless relaxed, multiplier of the right
/// sign and 0 off the bounds.
double conditionResidual(double value, double lower, double upper, double multiplier, double penalty) {
  double residual = std::abs(multiplier) - penalty;
  if (std::abs(multiplier) < penalty) residual = std::max({residual, lower - value, value - upper});
  if (multiplier > 0.0 && value < upper) residual = std::max(residual, std::min(multiplier, upper - value));
  if (multiplier < 0.0 && value > lower) residual = std::max(residual, std::min(-multiplier, value - lower));
  return residual;
}

double kktResidual(const Qp& qp, const BoundedQp& solver) {
  const Eigen::Map<const Eigen::VectorXd> x(solver.x(), qp.n());
  const Eigen::Map<const Eigen::VectorXd> on_bounds(solver.multipliers(), qp.n());
  const Eigen::Map<const Eigen::VectorXd> on_rows(solver.multipliers() + qp.n(), qp.m());
  double residual = (qp.H * x + qp.g + on_bounds + qp.A.transpose() * on_rows).cwiseAbs().maxCoeff();
  for (int i = 0; i < qp.n(); ++i) {
    residual = std::max(residual, conditionResidual(x(i), qp.lower(i), qp.upper(i), on_bounds(i), kInfinity));
  }
  const Eigen::VectorXd values = qp.A * x;
  for (int i = 0; i < qp.m(); ++i) {
    residual = std::max(
        residual, conditionResidual(values(i), qp.row_lower(i), qp.row_upper(i), on_rows(i), qp.penalty(i)));
  }
  return residual;
}

double tolerance(const Qp& qp) { return 1e-9 * (1.0 + qp.g.cwiseAbs().maxCoeff()); }

TEST(BoundedQp, MeetsTheOptimalityConditionsOfRandomBoxes) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 400; ++round) {
    const Qp qp = randomQp(1 + round % 61, 0, std::pow(10.0, 1 - round % 4), random);
    BoundedQp solver = solverFor(qp, round % 2 == 0);
    ASSERT_EQ(solver.solve(qp.vectors()), QpStatus::kOptimal) << "round " << round;
    EXPECT_LT(kktResidual(qp, solver), tolerance(qp)) << "round " << round;
  }
}

TEST(BoundedQp, MeetsTheOptimalityConditionsWithRows) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 400; ++round) {
    const int n = 1 + round % 41;
    Qp qp = randomQp(n, 1 + round % (2 * n), std::pow(10.0, 1 - round % 3), random);
    if (round % 5 == 0) qp.row_lower(0) = qp.row_upper(0) = 0.5 * qp.A.row(0).dot(qp.lower + qp.upper);
    if (round % 7 == 0) qp.lower(0) = qp.upper(0);
    if (round % 3 == 0) qp.penalty.setConstant(std::pow(10.0, round % 5 - 2));
    if (round % 4 == 0) qp.row_upper.setConstant(kInfinity);
    BoundedQp solver = solverFor(qp, round % 2 == 0);
    const QpStatus status = solver.solve(qp.vectors());
    // The fixed variable may contradict the rows.
    if (round % 7 == 0 && status == QpStatus::kInfeasible) continue;
    ASSERT_EQ(status, QpStatus::kOptimal) << "round " << round;
    EXPECT_LT(kktResidual(qp, solver), tolerance(qp)) << "round " << round;
  }
}

/// The best point over all active sets whose equality-constrained minimiser is feasible; no solver's logic.
double leastObjective(const Qp& qp) {
  const int n = qp.n();
  const int c = n + qp.m();
  Eigen::MatrixXd rows(c, n);
  rows << Eigen::MatrixXd::Identity(n, n), qp.A;
  Eigen::VectorXd lower(c), upper(c);
  lower << qp.lower, qp.row_lower;
  upper << qp.upper, qp.row_upper;
  int sets = 1;
  for (int i = 0; i < c; ++i) sets *= 3;
  double least = kInfinity;
  for (int set = 0; set < sets; ++set) {
    std::vector<int> active;
    Eigen::VectorXd values(c);
    int code = set;
    for (int i = 0; i < c; ++i, code /= 3) {
      if (code % 3 == 0) continue;
      values(static_cast<int>(active.size())) = code % 3 == 1 ? lower(i) : upper(i);
      active.push_back(i);
    }
    const int k = static_cast<int>(active.size());
    if (k > n) continue;
    Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(n + k, n + k);
    Eigen::VectorXd right(n + k);
    kkt.topLeftCorner(n, n) = qp.H;
    for (int j = 0; j < k; ++j) {
      kkt.block(n + j, 0, 1, n) = rows.row(active[static_cast<std::size_t>(j)]);
      kkt.block(0, n + j, n, 1) = rows.row(active[static_cast<std::size_t>(j)]).transpose();
    }
    right << -qp.g, values.head(k);
    const Eigen::VectorXd x = kkt.fullPivLu().solve(right).head(n);
    const Eigen::VectorXd at = rows * x;
    if (((at - upper).array() > 1e-9).any() || ((lower - at).array() > 1e-9).any()) continue;
    least = std::min(least, 0.5 * x.dot(qp.H * x) + qp.g.dot(x));
  }
  return least;
}

TEST(BoundedQp, NoActiveSetOfASmallProblemIsBetter) {
  std::mt19937_64 random(3);
  int infeasible = 0;
  for (int round = 0; round < 120; ++round) {
    Qp qp = randomQp(2 + round % 3, round % 4, 0.3, random);
    if (round % 5 == 4 && qp.m() > 0) {  // a row beyond what the box allows, or nearly
      const double most = qp.A.row(0).cwiseMax(0.0).dot(qp.upper) + qp.A.row(0).cwiseMin(0.0).dot(qp.lower);
      qp.row_lower(0) = most + (round % 2 == 0 ? 1e-3 : -1e-3);
      qp.row_upper(0) = kInfinity;
    }
    BoundedQp solver = solverFor(qp);
    const QpStatus status = solver.solve(qp.vectors());
    Qp finite = qp;
    for (int i = 0; i < qp.m(); ++i) finite.row_upper(i) = std::min(qp.row_upper(i), 1e3);
    const double least = leastObjective(finite);
    ASSERT_EQ(status, std::isfinite(least) ? QpStatus::kOptimal : QpStatus::kInfeasible) << "round " << round;
    if (status == QpStatus::kInfeasible) {
      ++infeasible;
      continue;
    }
    const Eigen::Map<const Eigen::VectorXd> x(solver.x(), qp.n());
    EXPECT_NEAR(0.5 * x.dot(qp.H * x) + qp.g.dot(x), least, 1e-9 * (1.0 + std::abs(least)))
        << "round " << round;
  }
  EXPECT_GT(infeasible, 3);
}

TEST(BoundedQp, AnyStartGivesTheSameMinimiser) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 100; ++round) {
    const Qp qp = randomQp(24, round % 2 == 0 ? 0 : 12, 0.3, random);
    BoundedQp cold = solverFor(qp);
    ASSERT_EQ(cold.solve(qp.vectors()), QpStatus::kOptimal);
    std::vector<QpSide> start(36);
    std::uniform_int_distribution<int> side(-2, 2);
    for (QpSide& entry : start) entry = static_cast<QpSide>(side(random));
    BoundedQp warm = solverFor(qp, round % 3 == 0);
    ASSERT_EQ(warm.solve(qp.vectors(), start.data()), QpStatus::kOptimal) << "round " << round;
    for (int i = 0; i < qp.n(); ++i) EXPECT_NEAR(warm.x()[i], cold.x()[i], 1e-9) << "round " << round;
    ASSERT_EQ(warm.solve(qp.vectors(), warm.activeSet()), QpStatus::kOptimal);
    EXPECT_LE(warm.iterations(), 2);
    EXPECT_LT(kktResidual(qp, warm), tolerance(qp));
  }
}

// Rows that were relaxed may not be any more, and the other way round.
TEST(BoundedQp, AnyStartGivesTheSameMinimiserWithRelaxedRows) {
  std::mt19937_64 random(6);
  int relaxed = 0;
  for (int round = 0; round < 100; ++round) {
    Qp qp = randomQp(24, 12, 0.3, random);
    qp.penalty = Eigen::VectorXd::NullaryExpr(12, [&](Eigen::Index i) { return std::pow(10.0, i % 4 - 1); });
    BoundedQp cold = solverFor(qp);
    ASSERT_EQ(cold.solve(qp.vectors()), QpStatus::kOptimal);
    relaxed += cold.violation() > 1e-6 ? 1 : 0;
    std::vector<QpSide> start(36);
    std::uniform_int_distribution<int> side(-2, 2);
    for (QpSide& entry : start) entry = static_cast<QpSide>(side(random));
    BoundedQp warm = solverFor(qp, round % 3 == 0);
    ASSERT_EQ(warm.solve(qp.vectors(), start.data()), QpStatus::kOptimal) << "round " << round;
    EXPECT_LT(kktResidual(qp, warm), tolerance(qp)) << "round " << round;
    for (int i = 0; i < qp.n(); ++i) EXPECT_NEAR(warm.x()[i], cold.x()[i], 1e-8) << "round " << round;
    ASSERT_EQ(warm.solve(qp.vectors(), warm.activeSet()), QpStatus::kOptimal);
    EXPECT_LE(warm.iterations(), 2);
    EXPECT_LT(kktResidual(qp, warm), tolerance(qp)) << "round " << round;
  }
  EXPECT_GT(relaxed, 50);
}

TEST(BoundedQp, PenaltyIsExactWhileItExceedsTheMultiplier) {
  std::mt19937_64 random(5);
  int relaxed = 0;
  for (int round = 0; round < 60; ++round) {
    Qp qp = randomQp(10, 8, 0.3, random);
    BoundedQp hard = solverFor(qp);
    ASSERT_EQ(hard.solve(qp.vectors()), QpStatus::kOptimal);
    double largest = 0.0;
    for (int i = 0; i < 8; ++i) largest = std::max(largest, std::abs(hard.multipliers()[10 + i]));
    if (largest < 1e-6) continue;
    qp.penalty.setConstant(1.01 * largest);
    BoundedQp exact = solverFor(qp);
    ASSERT_EQ(exact.solve(qp.vectors()), QpStatus::kOptimal);
    for (int i = 0; i < 10; ++i) EXPECT_NEAR(exact.x()[i], hard.x()[i], 1e-9);
    EXPECT_LT(exact.violation(), 1e-9);
    qp.penalty.setConstant(0.5 * largest);
    BoundedQp soft = solverFor(qp);
    ASSERT_EQ(soft.solve(qp.vectors()), QpStatus::kOptimal);
    EXPECT_LT(kktResidual(qp, soft), tolerance(qp));
    relaxed += soft.violation() > 1e-6 ? 1 : 0;
  }
  EXPECT_GT(relaxed, 20);
}

TEST(BoundedQp, ContradictionsAreRelaxedAtTheirPrice) {
  // min 1/2 x^2 with 1 <= x and x <= -1 as rows: any x in [-1, 1] violates by 2 in sum; x = 0 is cheapest.
  Qp qp;
  qp.H = Eigen::MatrixXd::Identity(1, 1);
  qp.g = Eigen::VectorXd::Zero(1);
  qp.lower = Eigen::VectorXd::Constant(1, -5.0);
  qp.upper = Eigen::VectorXd::Constant(1, 5.0);
  qp.A = Eigen::MatrixXd::Ones(2, 1);
  qp.row_lower = (Eigen::VectorXd(2) << 1.0, -kInfinity).finished();
  qp.row_upper = (Eigen::VectorXd(2) << kInfinity, -1.0).finished();
  qp.penalty = Eigen::VectorXd::Constant(2, kInfinity);
  BoundedQp hard = solverFor(qp);
  EXPECT_EQ(hard.solve(qp.vectors()), QpStatus::kInfeasible);
  qp.penalty.setConstant(100.0);
  BoundedQp soft = solverFor(qp);
  ASSERT_EQ(soft.solve(qp.vectors()), QpStatus::kOptimal);
  EXPECT_NEAR(soft.x()[0], 0.0, 1e-12);
  EXPECT_NEAR(soft.violation(), 1.0, 1e-12);
}

TEST(BoundedQp, DegenerateRowsDoNoHarm) {
  std::mt19937_64 random(6);
  for (int round = 0; round < 60; ++round) {
    Qp qp = randomQp(8, 21, 0.3, random);
    // Rows 7 to 13 are the first seven rows again, times 2.
    qp.A.middleRows(7, 7) = 2.0 * qp.A.topRows(7);
    qp.row_lower.segment(7, 7) = 2.0 * qp.row_lower.head(7);
    qp.row_upper.segment(7, 7) = 2.0 * qp.row_upper.head(7);
    qp.A.row(14).setZero();
    qp.row_lower(14) = -1.0;
    qp.row_upper(14) = 0.0;
    qp.A.row(15).setZero();  // a bound once more, as a row
    qp.A(15, 2) = 1.0;
    qp.row_lower(15) = qp.lower(2);
    qp.row_upper(15) = qp.upper(2);
    BoundedQp solver = solverFor(qp);
    ASSERT_EQ(solver.solve(qp.vectors()), QpStatus::kOptimal) << "round " << round;
    EXPECT_LT(kktResidual(qp, solver), tolerance(qp)) << "round " << round;
    const std::vector<QpSide> everything(29, QpSide::kUpper);
    ASSERT_EQ(solver.solve(qp.vectors(), everything.data()), QpStatus::kOptimal) << "round " << round;
    EXPECT_LT(kktResidual(qp, solver), tolerance(qp)) << "round " << round;
  }
}

TEST(BoundedQp, TouchingBoundsWithZeroMultipliersEnd) {
  // The unconstrained minimiser lies exactly on a corner of the box, whose bounds are then weakly active.
  std::mt19937_64 random(7);
  for (int round = 0; round < 60; ++round) {
    Qp qp = randomQp(20, 0, 1.0, random);
    Eigen::VectorXd corner(20);
    for (int i = 0; i < 20; ++i) corner(i) = i % 2 == 0 ? qp.lower(i) : qp.upper(i);
    qp.g = -qp.H * corner;
    BoundedQp solver = solverFor(qp, round % 2 == 0);
    ASSERT_EQ(solver.solve(qp.vectors()), QpStatus::kOptimal);
    for (int i = 0; i < 20; ++i) EXPECT_NEAR(solver.x()[i], corner(i), 1e-9);
  }
}

TEST(BoundedQp, IllConditionedProblemsAreRefined) {
  std::mt19937_64 random(12);
  for (int round = 0; round < 60; ++round) {
    Qp qp = randomQp(20, round % 2 == 0 ? 0 : 6, 0.5, random);
    const Eigen::MatrixXd Q = gaussian(20, 20, random).householderQr().householderQ();
    Eigen::VectorXd eigenvalues(20);
    for (int i = 0; i < 20; ++i) eigenvalues(i) = std::pow(10.0, -4.0 + 0.4 * i);
    qp.H = Q * eigenvalues.asDiagonal() * Q.transpose();
    qp.H = (0.5 * (qp.H + qp.H.transpose())).eval();
    qp.g = -qp.H * gaussian(20, 1, random);
    BoundedQp solver = solverFor(qp, round % 3 == 0);
    ASSERT_EQ(solver.solve(qp.vectors()), QpStatus::kOptimal) << "round " << round;
    EXPECT_LT(kktResidual(qp, solver), tolerance(qp)) << "round " << round;
  }
}

TEST(BoundedQp, StopsEarlyInsideTheBox) {
  std::mt19937_64 random(8);
  int stopped = 0;
  for (int round = 0; round < 100; ++round) {
    const Qp qp = randomQp(30, 20, 0.1, random);
    BoundedQp solver = solverFor(qp);
    for (int limit = 1; limit <= 8; ++limit) {
      solver.setIterationLimit(limit);
      const QpStatus status = solver.solve(qp.vectors());
      stopped += status == QpStatus::kIterationLimit ? 1 : 0;
      // its own residual tells the one from the other
      if (status == QpStatus::kIterationLimit) {
        EXPECT_GT(solver.kktResidual(), 1e-7);
      } else if (status == QpStatus::kOptimal) {
        EXPECT_LT(solver.kktResidual(), 1e-8);
      }
      EXPECT_LE(solver.iterations(), limit + 1);
      for (int i = 0; i < 30; ++i) {
        EXPECT_GE(solver.x()[i], qp.lower(i));
        EXPECT_LE(solver.x()[i], qp.upper(i));
      }
    }
  }
  EXPECT_GT(stopped, 100);
}

TEST(BoundedQp, RefusesWhatIsNoProblem) {
  Qp qp;
  qp.H = Eigen::MatrixXd::Identity(2, 2);
  qp.g = Eigen::VectorXd::Zero(2);
  qp.lower = Eigen::VectorXd::Constant(2, -1.0);
  qp.upper = Eigen::VectorXd::Constant(2, 1.0);
  BoundedQp solver = solverFor(qp);
  const Qp good = qp;
  qp.g(1) = std::nan("");
  EXPECT_EQ(solver.solve(qp.vectors()), QpStatus::kNotFinite);
  qp = good;
  qp.upper(0) = std::nan("");
  EXPECT_EQ(solver.solve(qp.vectors()), QpStatus::kNotFinite);
  qp = good;
  qp.lower(0) = 2.0;
  EXPECT_EQ(solver.solve(qp.vectors()), QpStatus::kInfeasible);
  EXPECT_EQ(solver.solve(good.vectors()), QpStatus::kOptimal);
  const Eigen::Matrix2d saddle = (Eigen::Matrix2d() << 1.0, 2.0, 2.0, 1.0).finished();
  const Eigen::Matrix2d broken = (Eigen::Matrix2d() << 1.0, 0.0, std::nan(""), 1.0).finished();
  for (const Eigen::Matrix2d& H : {saddle, broken}) {
    EXPECT_FALSE(solver.setHessian(H.data()));
    EXPECT_EQ(solver.solve(good.vectors()), QpStatus::kNotConvex);
  }
  EXPECT_EQ(polyfly_test::errorOf([] { BoundedQp(0, 0); }),
            "BoundedQp: needs at least 1 variable and 0 rows, got 0 and 0");
}

TEST(BoundedQp, NeverAllocates) {
  std::mt19937_64 random(9);
  const Qp qp = randomQp(30, 15, 0.2, random);
  BoundedQp solver = solverFor(qp);
  const long before = polyfly_test::allocationCount();
  solver.setHessian(qp.H.data());
  solver.setRows(qp.A.data());
  const QpStatus cold = solver.solve(qp.vectors());
  const QpStatus warm = solver.solve(qp.vectors(), solver.activeSet());
  EXPECT_EQ(polyfly_test::allocationCount(), before);
  EXPECT_EQ(cold, QpStatus::kOptimal);
  EXPECT_EQ(warm, QpStatus::kOptimal);
}

class ReferenceQps : public testing::TestWithParam<const char*> {};

TEST_P(ReferenceQps, AreSolvedTo1em9) {
  const std::string path = polyfly::referenceData("online_qps/" + std::string(GetParam()) + ".json");
  if (path.empty()) GTEST_SKIP() << "the reference data are absent";
  const nlohmann::json file = nlohmann::json::parse(std::ifstream(path));
  const int n = file["n"];
  BoundedQp solver(n);
  for (const bool warm : {false, true}) {
    int most = 0;
    for (const auto& instance : file["instances"]) {
      const std::vector<double> H = instance["H"], g = instance["g"], lower = instance["lb"];
      const std::vector<double> upper = instance["ub"], expected = instance["x_ref"];
      ASSERT_TRUE(file["h_const"] == 1 ? solver.setConstantHessian(H.data()) : solver.setHessian(H.data()));
      ASSERT_EQ(solver.solve({g.data(), lower.data(), upper.data()}, warm ? solver.activeSet() : nullptr),
                QpStatus::kOptimal);
      for (int i = 0; i < n; ++i) {
        EXPECT_NEAR(solver.x()[i], expected[static_cast<std::size_t>(i)], 1e-9) << instance["index"];
      }
      most = std::max(most, solver.iterations());
    }
    // The time of a control period is planned with 8; the solver's bound is 10 (n + m) + 30.
    EXPECT_LE(most, 8);
  }
}

INSTANTIATE_TEST_SUITE_P(Files, ReferenceQps,
                         testing::Values("lin_rand", "lin_seq", "fw_rand", "fw_seq", "fw_hard"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace polyfly
