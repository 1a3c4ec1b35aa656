// The real-time iteration against Eq. 37 integrated finely, differences in place of derivatives, and a dense
// step of Gauss and Newton assembled without condensing.
#include "nonlinear_mpc/nonlinear_mpc.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "allocations.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

using State9 = Eigen::Matrix<double, 9, 1>;

/// Right-hand side of Eq. 37 from rotations, the drag in the axes of the body.
State9 rate(const MultirotorModel& model, const StageConditions& stage, const State9& x,
            const MultirotorInput& u) {
  const Eigen::Matrix3d R =
      (Eigen::AngleAxisd(x(8), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(x(7), Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(x(6), Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  State9 result;
  const Eigen::Vector3d v = x.segment<3>(3);
  result.segment<3>(0) = v;
  result.segment<3>(3) = R * Eigen::Vector3d(0.0, 0.0, u(2)) - Eigen::Vector3d(0.0, 0.0, model.gravity) -
                         R * model.drag.asDiagonal() * R.transpose() * v + stage.disturbance;
  result(6) = (model.roll_gain * u(0) - x(6)) / model.roll_time;
  result(7) = (model.pitch_gain * u(1) - x(7)) / model.pitch_time;
  result(8) = stage.yaw_rate;
  return result;
}

MultirotorState integrateFinely(const MultirotorModel& model, double period, const StageConditions& stage,
                                const MultirotorState& start, const MultirotorInput& u) {
  constexpr int kSteps = 50;
  const double h = period / kSteps;
  State9 x;
  x << start, stage.yaw;
  for (int i = 0; i < kSteps; ++i) {
    const State9 k1 = rate(model, stage, x, u);
    const State9 k2 = rate(model, stage, x + 0.5 * h * k1, u);
    const State9 k3 = rate(model, stage, x + 0.5 * h * k2, u);
    const State9 k4 = rate(model, stage, x + h * k3, u);
    x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return x.head<8>();
}

class NonlinearMpcTest : public testing::Test {
 protected:
  double uniform(double limit) { return std::uniform_real_distribution<double>(-limit, limit)(random_); }
  Eigen::Vector3d vector(double limit) { return {uniform(limit), uniform(limit), uniform(limit)}; }

  MultirotorState randomState() {
    // Drawn one by one: GCC before 11 evaluates the operands of Eigen's comma from right to left.
    const Eigen::Vector3d position = vector(2.0), velocity = vector(3.0);
    const double roll = uniform(0.6), pitch = uniform(0.6);
    MultirotorState x;
    x << position, velocity, roll, pitch;
    return x;
  }
  MultirotorInput randomInput() { return {uniform(0.4), uniform(0.4), 9.8 + uniform(4.0)}; }
  StageConditions randomStage() { return {uniform(3.0), uniform(1.5), vector(2.0)}; }

  /// A flight past a point, with a yaw that turns and a wind.
  void randomProblem(const NonlinearMpcOptions& options, double scale = 1.0) {
    stages_.clear();
    references_.clear();
    const Eigen::Vector3d wind = vector(scale);
    const Eigen::Vector3d speed = vector(1.5 * scale);
    const double yaw = uniform(3.0);
    for (int k = 0; k <= options.horizon; ++k) {
      const double t = k * options.period;
      stages_.push_back({yaw + 0.5 * t, 0.5, wind});
      StageReference reference;
      reference.position = speed * t;
      reference.velocity = speed;
      reference.roll = uniform(0.1);
      reference.pitch_command = uniform(0.1);
      reference.lift = 9.8 + uniform(0.5);
      references_.push_back(reference);
    }
  }

  /// Rest at `goal`, in calm air.
  void restAt(const NonlinearMpcOptions& options, const Eigen::Vector3d& goal) {
    const auto count = static_cast<std::size_t>(options.horizon) + 1;
    StageReference reference;
    reference.position = goal;
    stages_.assign(count, StageConditions());
    references_.assign(count, reference);
  }

  std::mt19937_64 random_{11};
  std::vector<StageConditions> stages_;
  std::vector<StageReference> references_;
};

MultirotorModel strongDrag() {
  MultirotorModel model;
  model.drag = {0.3, 0.2, 0.1};
  return model;
}

TEST_F(NonlinearMpcTest, StageFollowsTheDifferentialEquation) {
  for (int round = 0; round < 100; ++round) {
    const MultirotorModel model = round % 2 == 0 ? strongDrag() : MultirotorModel();
    const StageConditions stage = randomStage();
    const MultirotorState x = randomState();
    const MultirotorInput u = randomInput();
    StageStep coarse, half;
    integrateStage(model, 0.1, stage, x, u, coarse);
    const MultirotorState fine = integrateFinely(model, 0.1, stage, x, u);
    const double error = (coarse.next - fine).cwiseAbs().maxCoeff();
    EXPECT_LT(error, 1e-4);
    integrateStage(model, 0.05, stage, x, u, half);
    const double half_error = (half.next - integrateFinely(model, 0.05, stage, x, u)).cwiseAbs().maxCoeff();
    if (error > 1e-8) {
      EXPECT_LT(half_error, error / 8.0);
    }
  }
}

TEST_F(NonlinearMpcTest, DerivativesAreThoseOfDifferences) {
  constexpr double kStep = 1e-5;
  for (int round = 0; round < 100; ++round) {
    const MultirotorModel model = strongDrag();
    const StageConditions stage = randomStage();
    const MultirotorState x = randomState();
    const MultirotorInput u = randomInput();
    StageStep step, plus, minus;
    integrateStage(model, 0.1, stage, x, u, step);
    for (int i = 0; i < 8; ++i) {
      const MultirotorState change = kStep * MultirotorState::Unit(i);
      integrateStage(model, 0.1, stage, x + change, u, plus);
      integrateStage(model, 0.1, stage, x - change, u, minus);
      EXPECT_LT((step.A.col(i) - (plus.next - minus.next) / (2.0 * kStep)).cwiseAbs().maxCoeff(), 1e-9);
    }
    for (int i = 0; i < 3; ++i) {
      const MultirotorInput change = kStep * MultirotorInput::Unit(i);
      integrateStage(model, 0.1, stage, x, u + change, plus);
      integrateStage(model, 0.1, stage, x, u - change, minus);
      EXPECT_LT((step.B.col(i) - (plus.next - minus.next) / (2.0 * kStep)).cwiseAbs().maxCoeff(), 1e-9);
    }
  }
}

/// The least-squares terms of the whole problem, in all states and inputs; the last entry of h included.
class SparseProblem {
 public:
  SparseProblem(const NonlinearMpcOptions& options, const std::vector<StageConditions>& stages,
                const std::vector<StageReference>& references)
      : options_(options), stages_(stages), references_(references) {
    const double T = options.model.gravity;
    Eigen::MatrixXd A(8, 8), B(8, 3);
    const StageConditions calm;
    const auto f = [&](const MultirotorState& x, const MultirotorInput& u) {
      return integrateFinely(options.model, options.period, calm, x, u);
    };
    for (int i = 0; i < 8; ++i) {
      A.col(i) = difference([&](double e) { return f(e * MultirotorState::Unit(i), {0, 0, T}); });
    }
    for (int i = 0; i < 3; ++i) {
      B.col(i) = difference([&](double e) {
        return f(MultirotorState::Zero(), MultirotorInput(0, 0, T) + e * MultirotorInput::Unit(i));
      });
    }
    MultirotorState q;
    q << options.position_weight, options.velocity_weight, options.roll_weight, options.pitch_weight;
    const Eigen::Vector3d r(options.roll_command_weight, options.pitch_command_weight, options.thrust_weight);
    P_ = solveRiccati(A, B, q.asDiagonal(), r.asDiagonal());
    const double yaw = stages[static_cast<std::size_t>(options.horizon)].yaw;
    Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(8, 8);
    turn.block(0, 0, 3, 3) = Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    turn.block(3, 3, 3, 3) = turn.block(0, 0, 3, 3);
    root_ = Eigen::MatrixXd(P_.llt().matrixL()).transpose() * turn;
  }

  template <class F>
  static Eigen::VectorXd difference(const F& f) {
    constexpr double kStep = 1e-5;
    return (f(kStep) - f(-kStep)) / (2.0 * kStep);
  }

  /// Weighted residuals of one stage.
  Eigen::VectorXd residual(int k, const MultirotorState& x, const MultirotorInput& u) const {
    const StageReference& reference = references_[static_cast<std::size_t>(k)];
    MultirotorState target;
    target << reference.position, reference.velocity, reference.roll, reference.pitch;
    if (k == options_.horizon) return root_ * (x - target);
    MultirotorState q;
    q << options_.position_weight, options_.velocity_weight, options_.roll_weight, options_.pitch_weight;
    Eigen::VectorXd r(11);
    r.head(8) = q.cwiseSqrt().cwiseProduct(x - target);
    r(8) = std::sqrt(options_.roll_command_weight) * (u(0) - reference.roll_command);
    r(9) = std::sqrt(options_.pitch_command_weight) * (u(1) - reference.pitch_command);
    r(10) = std::sqrt(options_.thrust_weight) * (std::cos(x(6)) * std::cos(x(7)) * u(2) - reference.lift);
    return r;
  }

  MultirotorState next(int k, const MultirotorState& x, const MultirotorInput& u) const {
    return integrateFinely(options_.model, options_.period, stages_[static_cast<std::size_t>(k)], x, u);
  }

  /// Half the sum of squares along the inputs from x.
  double objective(MultirotorState x, const Eigen::VectorXd& inputs) const {
    double sum = 0.0;
    for (int k = 0; k < options_.horizon; ++k) {
      const MultirotorInput u = inputs.segment<3>(3 * k);
      sum += 0.5 * residual(k, x, u).squaredNorm();
      x = next(k, x, u);
    }
    return sum + 0.5 * residual(options_.horizon, x, MultirotorInput::Zero()).squaredNorm();
  }

 private:
  NonlinearMpcOptions options_;
  std::vector<StageConditions> stages_;
  std::vector<StageReference> references_;
  Eigen::MatrixXd P_, root_;
};

/// Inputs after one step of Gauss and Newton from the states and inputs of `mpc`, without bounds: one dense
/// KKT system in states and inputs, all derivatives by differences.
Eigen::VectorXd denseStep(const SparseProblem& problem, const NonlinearMpc& mpc, const MultirotorState& x0) {
  const int N = mpc.horizon();
  const int variables = 11 * N + 8;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(variables, variables);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(variables);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(8 * (N + 1), variables);
  Eigen::VectorXd c = Eigen::VectorXd::Zero(8 * (N + 1));
  C.topLeftCorner(8, 8).setIdentity();
  c.head(8) = x0 - mpc.state(0);
  for (int k = 0; k <= N; ++k) {
    const MultirotorState& x = mpc.state(k);
    const MultirotorInput u = k < N ? mpc.input(k) : MultirotorInput::Zero();
    const int width = k < N ? 11 : 8;
    const Eigen::VectorXd r = problem.residual(k, x, u);
    Eigen::MatrixXd J(r.size(), width), F(8, width);
    for (int i = 0; i < width; ++i) {
      const auto moved = [&](double e) {
        return std::pair<MultirotorState, MultirotorInput>(
            i < 8 ? MultirotorState(x + e * MultirotorState::Unit(i)) : x,
            i < 8 ? u : MultirotorInput(u + e * MultirotorInput::Unit(i - 8)));
      };
      J.col(i) = SparseProblem::difference(
          [&](double e) { return problem.residual(k, moved(e).first, moved(e).second); });
      if (k == N) continue;
      F.col(i) = SparseProblem::difference(
          [&](double e) { return problem.next(k, moved(e).first, moved(e).second); });
    }
    H.block(11 * k, 11 * k, width, width) = J.transpose() * J;
    g.segment(11 * k, width) = J.transpose() * r;
    if (k == N) break;
    C.block(8 * (k + 1), 11 * k, 8, 11) = -F;
    C.block(8 * (k + 1), 11 * (k + 1), 8, 8).setIdentity();
    c.segment(8 * (k + 1), 8) = problem.next(k, x, u) - mpc.state(k + 1);
  }
  const int size = variables + static_cast<int>(c.size());
  Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(size, size);
  kkt.topLeftCorner(variables, variables) = H;
  kkt.bottomLeftCorner(c.size(), variables) = C;
  kkt.topRightCorner(variables, c.size()) = C.transpose();
  Eigen::VectorXd right(size);
  right << -g, c;
  const Eigen::VectorXd step = kkt.partialPivLu().solve(right);
  Eigen::VectorXd inputs(3 * N);
  for (int k = 0; k < N; ++k) inputs.segment<3>(3 * k) = mpc.input(k) + step.segment<3>(11 * k + 8);
  return inputs;
}

TEST_F(NonlinearMpcTest, OneStepIsThatOfTheWholeSystem) {
  for (int round = 0; round < 6; ++round) {
    NonlinearMpcOptions options;
    options.horizon = round % 2 == 0 ? 20 : 7;
    options.model = strongDrag();
    options.roll_weight = 4.0;
    options.pitch_weight = 25.0;
    options.roll_command_weight = 30.0;
    options.pitch_command_weight = 90.0;
    options.angle_max = 1.3;  // no bound is active
    options.thrust_min = 0.1;
    options.thrust_max = 60.0;
    randomProblem(options, 0.2);
    NonlinearMpc mpc(options);
    MultirotorState x = 0.05 * randomState();
    mpc.start(x, {0.05, -0.04, 10.0}, stages_.data());
    for (int step = 0; step < 3; ++step) {
      x += 0.01 * randomState();
      ASSERT_TRUE(mpc.prepare(stages_.data()));
      const SparseProblem problem(options, stages_, references_);
      const Eigen::VectorXd expected = denseStep(problem, mpc, x);
      const Eigen::Map<const Eigen::MatrixXd> inputs(expected.data(), 3, options.horizon);
      ASSERT_LT(inputs.topRows(2).cwiseAbs().maxCoeff(), options.angle_max);
      ASSERT_EQ(mpc.feedback(x, references_.data()), QpStatus::kOptimal);
      for (int k = 0; k < options.horizon; ++k) {
        EXPECT_LT((mpc.input(k) - expected.segment<3>(3 * k)).cwiseAbs().maxCoeff(), 2e-4)
            << "round " << round << ", step " << step << ", stage " << k;
      }
    }
  }
}

TEST_F(NonlinearMpcTest, IteratedItEndsAtAMinimumWithinTheBounds) {
  int active = 0;
  for (int round = 0; round < 8; ++round) {
    NonlinearMpcOptions options;
    randomProblem(options);
    NonlinearMpc mpc(options);
    const MultirotorState x = 0.7 * randomState();
    mpc.start(x, {0.0, 0.0, 9.8}, stages_.data());
    for (int step = 0; step < 40; ++step) {
      ASSERT_TRUE(mpc.prepare(stages_.data()));
      ASSERT_EQ(mpc.feedback(x, references_.data()), QpStatus::kOptimal);
    }
    EXPECT_LT(mpc.stepLength(), 1e-6) << "round " << round;
    const SparseProblem problem(options, stages_, references_);
    Eigen::VectorXd inputs(60);
    for (int k = 0; k < 20; ++k) inputs.segment<3>(3 * k) = mpc.input(k);
    const Eigen::Vector3d least(-options.angle_max, -options.angle_max, options.thrust_min);
    const Eigen::Vector3d greatest(options.angle_max, options.angle_max, options.thrust_max);
    for (int i = 0; i < 60; ++i) {
      const double slope = SparseProblem::difference([&](double e) {
        return Eigen::VectorXd::Constant(1, problem.objective(x, inputs + e * Eigen::VectorXd::Unit(60, i)));
      })(0);
      const double tolerance = 2e-4 * (1.0 + problem.objective(x, inputs));
      if (inputs(i) < greatest(i % 3) - 1e-9) {
        EXPECT_GT(slope, -tolerance) << "round " << round;
      }
      if (inputs(i) > least(i % 3) + 1e-9) {
        EXPECT_LT(slope, tolerance) << "round " << round;
      }
      active += std::abs(slope) > 10.0 * tolerance ? 1 : 0;
    }
  }
  EXPECT_GT(active, 10);
}

TEST_F(NonlinearMpcTest, SpeedLimitHoldsWhereItCanAndIsRelaxedWhereNot) {
  NonlinearMpcOptions options;
  options.speed_max = 1.0;
  restAt(options, {5.0, 0.0, 0.0});
  NonlinearMpc mpc(options);
  MultirotorState x = MultirotorState::Zero();
  const auto converge = [&] {
    mpc.start(x, {0.0, 0.0, 9.8}, stages_.data());
    for (int step = 0; step < 15; ++step) {
      ASSERT_TRUE(mpc.prepare(stages_.data()));
      ASSERT_EQ(mpc.feedback(x, references_.data()), QpStatus::kOptimal);
    }
  };
  converge();
  double fastest = 0.0;
  for (int k = 0; k <= 20; ++k) fastest = std::max(fastest, mpc.state(k)(3));
  EXPECT_NEAR(fastest, 1.0, 1e-6);
  x(3) = 2.5;  // too fast already: no input can help at once
  converge();
  EXPECT_GT(mpc.stateViolation(), 1.0);
  EXPECT_LT(mpc.state(12)(3), 1.0 + 1e-6);
}

TEST_F(NonlinearMpcTest, NeverAllocates) {
  NonlinearMpcOptions options;
  options.speed_max = 2.0;
  randomProblem(options);
  NonlinearMpc mpc(options);
  const MultirotorState x = randomState();
  const long before = polyfly_test::allocationCount();
  mpc.start(x, {0.0, 0.0, 9.8}, stages_.data());
  mpc.shift(0.1);
  const bool prepared = mpc.prepare(stages_.data());
  const QpStatus status = mpc.feedback(x, references_.data());
  EXPECT_EQ(polyfly_test::allocationCount(), before);
  EXPECT_TRUE(prepared);
  EXPECT_EQ(status, QpStatus::kOptimal);
}

TEST_F(NonlinearMpcTest, NumbersThatAreNotFiniteChangeNothing) {
  const NonlinearMpcOptions options;
  randomProblem(options);
  NonlinearMpc mpc(options);
  MultirotorState x = MultirotorState::Zero();
  mpc.start(x, {0.0, 0.0, 9.8}, stages_.data());
  ASSERT_TRUE(mpc.prepare(stages_.data()));
  x(4) = std::nan("");
  EXPECT_EQ(mpc.feedback(x, references_.data()), QpStatus::kNotFinite);
  EXPECT_TRUE(mpc.state(0).allFinite());
  EXPECT_TRUE(mpc.input(0).allFinite());
}

TEST(NonlinearMpcOptionsTest, AreChecked) {
  NonlinearMpcOptions options;
  options.horizon = 0;
  EXPECT_THROW(NonlinearMpc{options}, Error);
  options = {};
  options.thrust_min = 25.0;
  EXPECT_THROW(NonlinearMpc{options}, Error);
}

}  // namespace
}  // namespace polyfly
