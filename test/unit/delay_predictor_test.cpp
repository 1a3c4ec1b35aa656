// What is predicted over a dead time, beside matrix exponentials of the linear model and beside the plant.
#include "online_controller/estimation/delay_predictor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "polyfly_base/error.hpp"
#include "polyfly_test/multirotor_plant.hpp"

namespace polyfly {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kPeriod = 0.01;  // [s]

AttitudeCommand command(double roll, double pitch, double thrust) { return {roll, pitch, 0.0, thrust}; }

/// exp(A t) by its series, halved until it converges fast.
MatrixXd exponential(const MatrixXd& A, double t) {
  constexpr int kHalvings = 6, kTerms = 20;
  const MatrixXd small = A * (t / std::exp2(kHalvings));
  MatrixXd sum = MatrixXd::Identity(A.rows(), A.rows()), term = sum;
  for (int k = 1; k <= kTerms; ++k) sum += term = term * small / k;
  for (int i = 0; i < kHalvings; ++i) sum = (sum * sum).eval();
  return sum;
}

/// x' = A x + b u over `duration` with u held.
VectorXd moved(const MatrixXd& A, const VectorXd& b, const VectorXd& x, double u, double duration) {
  const Eigen::Index n = x.size();
  MatrixXd augmented = MatrixXd::Zero(n + 1, n + 1);
  augmented.topLeftCorner(n, n) = A;
  augmented.topRightCorner(n, 1) = b;
  VectorXd both(n + 1);
  both << x, u;
  return (exponential(augmented, duration) * both).head(n);
}

DelayPredictor predictorOf(double delay, const VehicleModel& model = {}, MultirotorOptions options = {}) {
  options.delay = delay;
  return {model, options};
}

struct SentAt {
  double stamp;
  AttitudeCommand command;
};

/// Position, velocity and angle (or without it) of one linear axis, `delay` after a state of the time `now`.
VectorXd exactAhead(const MatrixXd& A, const VectorXd& b, VectorXd x, double now, double delay,
                    const std::vector<SentAt>& sent,
                    const std::function<double(const AttitudeCommand&)>& input) {
  double at = now - delay;
  while (at < now) {
    // The last one that was sent by now holds; the first stands for all before it.
    std::size_t acting = 0;
    double until = now;
    for (std::size_t i = 0; i < sent.size(); ++i) {
      if (sent[i].stamp <= at) acting = i;
      if (sent[i].stamp > at) until = std::min(until, sent[i].stamp);
    }
    x = moved(A, b, x, input(sent[acting].command), until - at);
    at = until;
  }
  return x;
}

TEST(DelayPredictor, FollowsTheLinearModelForSmallAngles) {
  VehicleModel model;
  model.motion = {9.8066, 0.9, 0.25, 0.85, 0.2, {0.3, 0.2, 0.1}};
  const MultirotorOptions options;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  MatrixXd A_x(3, 3), A_y(3, 3), A_z(2, 2);
  A_x << 0, 1, 0, 0, -0.3, 9.8066, 0, 0, -1.0 / 0.2;
  A_y << 0, 1, 0, 0, -0.2, -9.8066, 0, 0, -1.0 / 0.25;
  A_z << 0, 1, 0, -0.1;
  const VectorXd b_x = Vector3d(0, 0, 0.85 / 0.2), b_y = Vector3d(0, 0, 0.9 / 0.25),
                 b_z = Eigen::Vector2d(0, 1);
  for (int trial = 0; trial < 60; ++trial) {
    const double delay = trial % 3 == 0 ? 0.06 : 0.25 * (unit(random) + 1.0);
    // Small enough that the model's products do not show.
    const double small = 1e-5;
    DelayPredictor predictor = predictorOf(delay, model);
    std::vector<SentAt> sent;
    double stamp = 100.0;
    for (int i = 0; i < trial % 40; ++i, stamp += kPeriod * (1.0 + 0.3 * unit(random))) {
      sent.push_back({stamp, command(small * unit(random), small * unit(random),
                                     options.mass * (9.8066 + small * unit(random)))});
      predictor.sent(stamp, sent.back().command);
    }
    sent.insert(sent.begin(), {-1e9, command(0.0, 0.0, options.mass * 9.8066)});
    VehicleState state;
    state.stamp = stamp;
    for (int i = 0; i < 3; ++i) state.position[i] = unit(random), state.velocity[i] = small * unit(random);
    const double roll = small * unit(random), pitch = small * unit(random);
    state.attitude = Eigen::AngleAxisd(pitch, Vector3d::UnitY()) * Eigen::AngleAxisd(roll, Vector3d::UnitX());
    const VehicleState ahead = predictor.ahead(state);
    const auto axis = [&](int i, double angle) {
      return Vector3d(state.position[i], state.velocity[i], angle);
    };
    const VectorXd x = exactAhead(A_x, b_x, axis(0, pitch), stamp, delay, sent,
                                  [](const AttitudeCommand& u) { return u.pitch; });
    const VectorXd y = exactAhead(A_y, b_y, axis(1, roll), stamp, delay, sent,
                                  [](const AttitudeCommand& u) { return u.roll; });
    const VectorXd z = exactAhead(A_z, b_z, axis(2, 0.0).head<2>(), stamp, delay, sent,
                                  [&](const AttitudeCommand& u) { return u.thrust / options.mass - 9.8066; });
    const double tolerance = 1e-5 * small;
    const EulerAngles angles = eulerAngles(ahead.attitude);
    EXPECT_NEAR(angles.pitch, x(2), tolerance) << trial;
    EXPECT_NEAR(angles.roll, y(2), tolerance) << trial;
    const std::array<const VectorXd*, 3> axes{&x, &y, &z};
    for (int i = 0; i < 3; ++i) {
      // The vertical axis feels the square of the angles.
      const double room = i == 2 ? 100.0 * small * small : 0.0;
      EXPECT_NEAR(ahead.position[i], (*axes[static_cast<std::size_t>(i)])(0), tolerance + room)
          << trial << " " << i;
      EXPECT_NEAR(ahead.velocity[i], (*axes[static_cast<std::size_t>(i)])(1), tolerance + room)
          << trial << " " << i;
    }
    EXPECT_EQ(ahead.stamp, state.stamp);
  }
}

// The trapezoidal rule in steps of 0.01 s leaves less than a hundredth of the motion.
TEST(DelayPredictor, FollowsLoopsOfSecondOrder) {
  VehicleModel model;
  model.motion = {9.8066, 0.9, 19.2 / 144.0, 0.9, 19.2 / 144.0, Vector3d::Zero()};
  model.roll = model.pitch = {144.0, 19.2};
  MatrixXd A(4, 4);
  A << 0, 1, 0, 0, 0, 0, -9.8066, 0, 0, 0, 0, 1, 0, 0, -144, -19.2;
  const VectorXd b = (VectorXd(4) << 0, 0, 0, 129.6).finished();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int trial = 0; trial < 40; ++trial) {
    DelayPredictor predictor = predictorOf(0.06, model);
    const double small = 1e-4;
    std::vector<SentAt> sent{{-1e9, command(0.0, 0.0, 1.52 * 9.8066)}};
    for (int i = 0; i < 8; ++i) {
      sent.push_back({kPeriod * i, command(small * unit(random), 0.0, 1.52 * 9.8066)});
      predictor.sent(sent.back().stamp, sent.back().command);
    }
    VehicleState state;
    state.stamp = kPeriod * 8;
    VectorXd y = VectorXd::Zero(4);
    for (const Eigen::Index k : {2, 3}) y[k] = (k == 2 ? small : 10.0 * small) * unit(random);
    state.attitude = Eigen::AngleAxisd(y(2), Vector3d::UnitX());
    state.angular_velocity.x() = y(3);
    const VectorXd exact =
        exactAhead(A, b, y, state.stamp, 0.06, sent, [](const AttitudeCommand& u) { return u.roll; });
    const VehicleState ahead = predictor.ahead(state);
    EXPECT_NEAR(eulerAngles(ahead.attitude).roll, exact(2), 0.01 * small) << trial;
    EXPECT_NEAR(ahead.angular_velocity.x(), exact(3), 0.1 * small) << trial;
    EXPECT_NEAR(ahead.velocity.y(), exact(1), 0.01 * small) << trial;
  }
}

/// The plant is Eq. 37 as another hand integrates it.
TEST(DelayPredictor, IsWhereThePlantWillBe) {
  for (const double delay : {0.06, 0.043, 0.1}) {
    PlantOptions options;
    options.command_delay = delay;
    options.wind = {0.8, -0.5, 0.3};
    options.roll_offset = 0.02;
    PlantState start;
    start.thrust = options.gravity;
    MultirotorPlant plant(options, start);
    DelayPredictor predictor = predictorOf(delay);
    predictor.setDisturbance(options.wind);
    struct Promised {
      double time;
      VehicleState state;
    };
    std::vector<Promised> promised;
    double worst_position = 0.0, worst_velocity = 0.0, worst_attitude = 0.0, unpredicted = 0.0;
    for (int k = 0; k < 1500; ++k) {
      const VehicleState state = plant.measure();
      const double t = state.stamp;
      const VehicleState ahead = predictor.ahead(state);
      if (t > 11.0) promised.push_back({t + delay, ahead});
      const AttitudeCommand next{0.2 * std::sin(1.7 * t), 0.15 * std::cos(2.9 * t), 0.4 * std::sin(0.3 * t),
                                 1.52 * (9.8066 + std::sin(4.1 * t))};
      predictor.sent(t, next);
      plant.advance(next);
      // Where a sample hits the promised time to within the plant's step.
      for (const Promised& one : promised) {
        const double late = plant.time() - one.time;
        if (late < 0.0 || late >= kPeriod) continue;
        const VehicleState truth = plant.truth();
        const Vector3d position = truth.position - late * truth.velocity;
        worst_position = std::max(worst_position, (position - one.state.position).norm());
        if (late > 1e-6) continue;
        worst_velocity = std::max(worst_velocity, (truth.velocity - one.state.velocity).norm());
        worst_attitude = std::max(worst_attitude, truth.attitude.angularDistance(one.state.attitude));
      }
      unpredicted = std::max(unpredicted, delay * state.velocity.norm());
    }
    EXPECT_GT(unpredicted, 0.05);
    EXPECT_LT(worst_position, 1e-3) << delay;
    EXPECT_LT(worst_velocity, 0.01) << delay;
    EXPECT_LT(worst_attitude, 0.002) << delay;
  }
}

TEST(DelayPredictor, WithoutADelayTheStateComesBack) {
  DelayPredictor predictor = predictorOf(0.0);
  VehicleState state;
  state.position = {1.0, 2.0, 3.0};
  state.velocity = {3.0, 2.0, 1.0};
  const VehicleState ahead = predictor.ahead(state);
  EXPECT_EQ(ahead.position, state.position);
  EXPECT_EQ(ahead.velocity, state.velocity);
  EXPECT_EQ(ahead.attitude.coeffs(), state.attitude.coeffs());
}

TEST(DelayPredictor, NumbersThatAreNoneChangeNothing) {
  DelayPredictor predictor = predictorOf(0.06), other = predictor;
  VehicleState state;
  state.velocity = {1.0, 0.0, 0.0};
  VehicleState bad = state;
  bad.velocity.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(predictor.ahead(bad).velocity.x()));
  predictor.sent(std::numeric_limits<double>::quiet_NaN(), command(0.3, 0.3, 1.0));
  EXPECT_EQ(predictor.ahead(state).position, other.ahead(state).position);
  EXPECT_NEAR(other.ahead(state).position.x(), 0.06, 1e-4);
}

// More commands than there is room for: the oldest stands for those before it. A clock that goes back: the same.
TEST(DelayPredictor, StaysBoundedWhenCommandsComeTooOftenOrTimeGoesBack) {
  DelayPredictor predictor = predictorOf(0.5);
  VehicleState state;
  for (int k = 0; k < 1000; ++k) {
    state.stamp = 0.001 * (k < 700 ? k : k - 600);
    const VehicleState ahead = predictor.ahead(state);
    ASSERT_TRUE(ahead.position.allFinite());
    EXPECT_LT(ahead.position.norm(), 0.5);
    predictor.sent(state.stamp, command(0.01 * std::sin(k), 0.0, 1.52 * 9.8066));
  }
}

TEST(DelayPredictor, RefusesDelaysThatItCannotHold) {
  MultirotorOptions options;
  options.control_period = 0.004;
  const auto complaint = [&](double delay) -> std::string {
    try {
      VehicleModel model;
      model.delay = delay;
      DelayPredictor(model, options);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint(0.396), "");
  EXPECT_NE(complaint(0.4).find("vehicle/delay: must be at most 99 times controller/control_period"),
            std::string::npos);
  EXPECT_NE(complaint(0.6).find("vehicle/delay: must be 0 to 0.5 s"), std::string::npos);
  EXPECT_NE(complaint(-0.1).find("vehicle/delay: must be 0 to 0.5 s"), std::string::npos);
}

}  // namespace
}  // namespace polyfly
