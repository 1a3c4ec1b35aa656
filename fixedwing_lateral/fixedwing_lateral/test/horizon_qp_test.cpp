// The structured program against the conditions of optimality of the dense one, condensed here by itself.
#include "fixedwing_lateral/horizon_qp.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <random>

#include "fixedwing_lateral/roll_shooting.hpp"
#include "mpc_core/dense_qp.hpp"

namespace {

using namespace polyfly;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kOptimality = 1e-8;

/// The same program over the moves alone; roll = roll_at_rest + roll_by_move u.
struct Dense {
  MatrixXd H;
  VectorXd g;
  MatrixXd roll_by_move;
  VectorXd roll_at_rest;
};

Dense condense(HorizonQp& qp, const VectorXd& x_0) {
  const int N = qp.horizon();
  Dense dense{MatrixXd::Zero(N, N), VectorXd::Zero(N), MatrixXd::Zero(N, N), VectorXd::Zero(N)};
  MatrixXd by_move = MatrixXd::Zero(5, N);
  VectorXd rest = x_0;
  for (int k = 0; k <= N; ++k) {
    const HorizonStage& s = qp.stages()[k];
    dense.H += by_move.transpose() * s.Q * by_move;
    dense.g += by_move.transpose() * (s.Q * rest + s.q);
    if (k > 0) {
      dense.roll_by_move.row(k - 1) = by_move.row(3);
      dense.roll_at_rest(k - 1) = rest(3);
    }
    if (k == N) break;
    dense.H(k, k) += s.R;
    dense.g(k) += s.r;
    by_move = s.A * by_move;
    by_move.col(k) += s.B;
    rest = s.A * rest + s.gap;
  }
  return dense;
}

/// The least violation of the conditions that make a point the optimum of the relaxed program.
double violation(HorizonQp& qp, const Dense& dense) {
  const int N = qp.horizon();
  const Eigen::Map<const VectorXd> u(qp.moves(), N);
  const Eigen::Map<const VectorXd> lambda(qp.multipliers(), 2 * N);
  const VectorXd roll = dense.roll_at_rest + dense.roll_by_move * u;
  const VectorXd gradient =
      dense.H * u + dense.g + lambda.head(N) + dense.roll_by_move.transpose() * lambda.tail(N);
  double worst = gradient.cwiseAbs().maxCoeff();
  for (int c = 0; c < 2 * N; ++c) {
    const bool is_move = c < N;
    const Interval& bound = is_move ? qp.moveBounds()[c] : qp.rollBounds()[c - N];
    const double value = is_move ? u(c) : roll(c - N);
    const double above = value - bound.upper;
    const double below = bound.lower - value;
    const bool relaxed = !is_move && std::abs(lambda(c)) >= qp.rho * (1.0 - 1e-9);
    if (!is_move) worst = std::max(worst, std::abs(lambda(c)) - qp.rho);
    if (!relaxed) worst = std::max({worst, above, below});
    // A multiplier pushes from its own bound only, and from one that holds (or, relaxed, is exceeded).
    if (lambda(c) > 0.0) worst = std::max(worst, relaxed ? -above : std::abs(above));
    if (lambda(c) < 0.0) worst = std::max(worst, relaxed ? -below : std::abs(below));
  }
  for (int k = 1; k <= N; ++k)
    worst = std::max(worst, std::abs(qp.states()[k][HorizonStage::kRoll] - roll(k - 1)));
  return worst;
}

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double operator()(double scale = 1.0) {
    return scale * std::uniform_real_distribution<double>(-1.0, 1.0)(random_);
  }

 private:
  std::mt19937 random_;
};

void fill(HorizonQp& qp, Draw& draw, double stiffness) {
  const RollShooting shooting(LateralModel{}, 0.1);
  for (int k = 0; k <= qp.horizon(); ++k) {
    HorizonStage& s = qp.stages()[k];
    shooting.shoot({}, LateralState::Zero(), 0.0, s);
    for (int row = 0; row < 2; ++row) {
      s.A.row(row).tail<3>() << draw(1.4), draw(0.05), draw(0.005);
      s.B(row) = draw(0.002);
    }
    s.A.row(2).tail<2>() << 0.07 + draw(0.01), 0.003 + draw(0.001);
    s.B(2) = 0.002 + draw(0.001);
    for (int i = 0; i < 5; ++i) s.gap[i] = draw(0.02);
    const Eigen::Vector3d a(draw(), draw(), draw());
    const Eigen::Vector3d b(draw(0.1), draw(0.1), draw());
    s.Q.topLeftCorner<3, 3>() = stiffness * (0.01 * a * a.transpose() + 10.0 * b * b.transpose());
    s.Q.diagonal().tail<2>() << 0.1, 0.01;
    for (int i = 0; i < 5; ++i) s.q[i] = stiffness * draw(0.5);
    s.R = 5.0 + draw(4.0);
    s.r = draw(3.0);
  }
  for (int k = 0; k < qp.horizon(); ++k) {
    qp.moveBounds()[k] = {-0.6 + draw(0.2), 0.6 + draw(0.2)};
    qp.rollBounds()[k] = {-0.5 + draw(0.2), 0.5 + draw(0.2)};
  }
}

VectorXd start(Draw& draw, double roll = 0.3) {
  VectorXd x_0(5);
  Eigen::Index k = 0;
  for (const double size : {1.0, 1.0, 0.1, roll, 0.5}) x_0[k++] = draw(size);
  return x_0;
}

TEST(HorizonQp, MeetsTheOptimalityConditions) {
  Draw draw(1);
  int most_active = 0;
  for (const int horizon : {1, 2, 7, 40}) {
    HorizonQp qp(horizon);
    for (int i = 0; i < 150; ++i) {
      fill(qp, draw, i % 3 == 0 ? 1.0 : 30.0);
      const VectorXd x_0 = start(draw);
      ASSERT_TRUE(qp.prepare());
      ASSERT_EQ(qp.solve(x_0.data()), QpStatus::kOptimal) << horizon << ": " << i;
      EXPECT_LT(violation(qp, condense(qp, x_0)), kOptimality) << horizon << ": " << i;
      most_active = std::max(most_active, qp.activeCount());
      if (i % 4 == 0) qp.coldStart();
    }
  }
  EXPECT_GT(most_active, 15);
}

TEST(HorizonQp, AgreesWithTheDenseSolver) {
  Draw draw(2);
  HorizonQp qp(20);
  int feasible = 0;
  for (int i = 0; i < 60; ++i) {
    fill(qp, draw, 10.0);
    qp.rho = 1e5;
    const VectorXd x_0 = start(draw, 0.2);
    const Dense dense = condense(qp, x_0);
    MatrixXd A(80, 20);
    A << MatrixXd::Identity(20, 20), -MatrixXd::Identity(20, 20), dense.roll_by_move, -dense.roll_by_move;
    VectorXd b(80);
    for (int k = 0; k < 20; ++k) {
      b(k) = qp.moveBounds()[k].upper;
      b(20 + k) = -qp.moveBounds()[k].lower;
      b(40 + k) = qp.rollBounds()[k].upper - dense.roll_at_rest(k);
      b(60 + k) = -qp.rollBounds()[k].lower + dense.roll_at_rest(k);
    }
    DenseQp reference(dense.H, A);
    ASSERT_TRUE(qp.prepare());
    ASSERT_EQ(qp.solve(x_0.data()), QpStatus::kOptimal);
    if (reference.solve(dense.g.data(), b.data()) != QpStatus::kOptimal) continue;
    ++feasible;
    for (int k = 0; k < 20; ++k) EXPECT_NEAR(qp.moves()[k], reference.z()(k), kOptimality);
  }
  EXPECT_GT(feasible, 20);
}

TEST(HorizonQp, RelaxesRollThatCannotBeHeld) {
  Draw draw(3);
  HorizonQp qp(30);
  int relaxed = 0;
  for (int i = 0; i < 60; ++i) {
    fill(qp, draw, 5.0);
    for (int k = 0; k < 30; ++k) qp.rollBounds()[k] = {-0.1, 0.1};
    VectorXd x_0 = start(draw);
    x_0(3) = i % 2 == 0 ? 0.9 : -0.9;
    ASSERT_TRUE(qp.prepare());
    ASSERT_EQ(qp.solve(x_0.data()), QpStatus::kOptimal);
    EXPECT_LT(violation(qp, condense(qp, x_0)), 1e2 * kOptimality);  // multipliers of 1e3
    for (int c = 30; c < 60; ++c) relaxed += std::abs(qp.multipliers()[c]) > 0.999 * qp.rho ? 1 : 0;
  }
  EXPECT_GT(relaxed, 60);
}

TEST(HorizonQp, WarmStartsAlongASequence) {
  Draw draw(4);
  HorizonQp warm(40);
  HorizonQp cold(40);
  fill(warm, draw, 30.0);
  VectorXd x_0 = start(draw);
  int warm_iterations = 0;
  int cold_iterations = 0;
  for (int i = 0; i < 50; ++i) {
    for (int k = 0; k <= 40; ++k) warm.stages()[k].q[2] += draw(0.3);
    std::copy(warm.stages(), warm.stages() + 41, cold.stages());
    std::copy(warm.moveBounds(), warm.moveBounds() + 40, cold.moveBounds());
    std::copy(warm.rollBounds(), warm.rollBounds() + 40, cold.rollBounds());
    cold.coldStart();
    ASSERT_TRUE(warm.prepare());
    ASSERT_TRUE(cold.prepare());
    ASSERT_EQ(warm.solve(x_0.data()), QpStatus::kOptimal);
    ASSERT_EQ(cold.solve(x_0.data()), QpStatus::kOptimal);
    warm_iterations += warm.iterations();
    cold_iterations += cold.iterations();
    EXPECT_LT(violation(warm, condense(warm, x_0)), kOptimality);
    for (int k = 0; k < 40; ++k) EXPECT_NEAR(warm.moves()[k], cold.moves()[k], kOptimality);
  }
  EXPECT_LT(2 * warm_iterations, cold_iterations);
}

TEST(HorizonQp, BoundsThatLeaveNoRoomAndBoundsThatTouch) {
  Draw draw(5);
  HorizonQp qp(12);
  for (int i = 0; i < 50; ++i) {
    fill(qp, draw, 30.0);
    for (int k = 0; k < 12; k += 2) qp.moveBounds()[k].upper = qp.moveBounds()[k].lower = draw(0.4);
    const VectorXd x_0 = start(draw);
    const Dense dense = condense(qp, x_0);
    // The first roll bound lies exactly where the first move leads: one of the two follows from the other.
    const double first = dense.roll_at_rest(0) + dense.roll_by_move(0, 0) * qp.moveBounds()[0].upper;
    qp.rollBounds()[0] = {first - 0.3, first};
    ASSERT_TRUE(qp.prepare());
    ASSERT_EQ(qp.solve(x_0.data()), QpStatus::kOptimal) << i;
    EXPECT_LT(violation(qp, dense), kOptimality);
  }
}

TEST(HorizonQp, SaysThatDataAreNotFinite) {
  Draw draw(6);
  HorizonQp qp(10);
  fill(qp, draw, 1.0);
  VectorXd x_0 = start(draw);
  ASSERT_TRUE(qp.prepare());
  x_0(1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(qp.solve(x_0.data()), QpStatus::kNotFinite);
  x_0(1) = 0.0;
  EXPECT_EQ(qp.solve(x_0.data()), QpStatus::kOptimal);
  qp.stages()[4].q[0] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(qp.prepare());
  qp.stages()[4].q[0] = 0.0;
  qp.stages()[3].R = -1e6;
  EXPECT_FALSE(qp.prepare());
}

}  // namespace
