// The laws over a dead time between odometry and command: what is predicted, and what it brings in flight.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "allocations.hpp"
#include "online_controller/estimation/delay_predictor.hpp"
#include "online_controller/flight/flight_supervisor.hpp"
#include "online_controller/laws/law_registry.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"
#include "polyfly_test/multirotor_plant.hpp"
#include "project_root.hpp"
#include "robust_mpc/robust_law.hpp"
#include "solved_maps.hpp"

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
    const VectorXd y =
        (VectorXd(4) << 0.0, 0.0, small * unit(random), 10.0 * small * unit(random)).finished();
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

using Path = std::function<Reference(double)>;

/// A circle with a climb, from rest to `speed` within 5 s.
Path helix(double radius, double speed, double climb) {
  return [=](double time) {
    constexpr double kRamp = 5.0;
    const double x = std::clamp(time / kRamp, 0.0, 1.0), w0 = speed / radius;
    const double phase = kRamp * x * x * x * x * (2.5 - 3.0 * x + x * x) + std::max(0.0, time - kRamp);
    const double rate = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
    const double w = w0 * rate, a = w0 * 30.0 * x * x * (1.0 - x) * (1.0 - x) / kRamp;
    const double j = w0 * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (kRamp * kRamp);
    const Vector3d out(std::cos(w0 * phase), std::sin(w0 * phase), 0.0), along(-out.y(), out.x(), 0.0);
    Reference reference;
    reference.position = radius * out + Vector3d(0.0, 0.0, climb * phase);
    reference.velocity = radius * w * along + Vector3d(0.0, 0.0, climb * rate);
    reference.acceleration = radius * (a * along - w * w * out) + Vector3d(0.0, 0.0, climb * a / w0);
    reference.jerk =
        radius * ((j - w * w * w) * along - 3.0 * w * a * out) + Vector3d(0.0, 0.0, climb * j / w0);
    return reference;
  };
}

Path step() {
  return [](double time) {
    Reference reference;
    // Beyond the horizon at first; between two samples, whatever rounding does.
    if (time >= 4.0035) reference.position = {1.0, 0.6, 0.5};
    return reference;
  };
}

std::array<MpcProblem, 3> problems(const std::string& folder = "multirotor_") {
  return {loadProblem(problemFile(folder + "longitudinal.yaml")),
          loadProblem(problemFile(folder + "lateral.yaml")),
          loadProblem(problemFile(folder + "vertical.yaml"))};
}

const std::vector<RegionMap>& maps() {
  static const std::vector<RegionMap> kOnce = solvedMaps(problems("look_ahead/"), "dead_time_test_");
  return kOnce;
}

std::unique_ptr<ControlLaw> lawOf(const std::string& name, const MultirotorOptions& options) {
  if (name == "nonlinear") return std::make_unique<NonlinearController>(options, NonlinearMpcOptions{});
  if (name == "linear") return std::make_unique<MultirotorController>(problems(), options);
  return std::make_unique<MultirotorController>(
      std::array<const RegionMap*, 3>{&maps()[0], &maps()[1], &maps()[2]}, options);
}

const std::array<std::string, 3> kNames{"linear", "explicit_linear", "nonlinear"};

std::unique_ptr<LawSwitch> switchOf(const std::string& name, double delay) {
  MultirotorOptions options;
  options.delay = delay;
  return std::make_unique<LawSwitch>(lawOf(name, options), options);
}

struct Flown {
  double rms = 0.0;       ///< distance from the path [m]
  double greatest = 0.0;  ///< the same [m]
  std::vector<Vector3d> way;
};

/// What happens to the law before a sample; false: the sample is lost.
using OnSample = std::function<bool(int, std::unique_ptr<LawSwitch>&)>;

Flown fly(std::unique_ptr<LawSwitch> law, const Path& path, PlantOptions options, double delay,
          const OnSample& on_sample = {}, double from = 0.0) {
  constexpr double kSeconds = 16.0;
  options.command_delay = delay;
  PlantState start;
  start.position = path(0.0).position;
  start.thrust = options.gravity;
  MultirotorPlant plant(options, start);
  std::vector<Reference> preview(64);
  Flown flown;
  AttitudeCommand sent = command(0.0, 0.0, options.mass * options.gravity);
  int counted = 0;
  for (int sample = 0; plant.time() < kSeconds - 0.5 * kPeriod; ++sample) {
    const VehicleState state = plant.measure();
    if (!on_sample || on_sample(sample, law)) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(law->previewLength()); ++k)
        preview[k] = path(state.stamp + law->lead() + static_cast<double>(k) * law->previewPeriod());
      sent = law->step(state, preview.data()).command;
      law->prepare();
    }
    plant.advance(sent);
    flown.way.push_back(plant.state().position);
    if (plant.time() < from) continue;
    const double error = (plant.state().position - path(plant.time()).position).norm();
    flown.rms += error * error;
    flown.greatest = std::max(flown.greatest, error);
    ++counted;
  }
  flown.rms = std::sqrt(flown.rms / counted);
  return flown;
}

Flown fly(const std::string& law, const Path& path, const PlantOptions& plant, double delay, double told) {
  return fly(switchOf(law, told), path, plant, delay);
}

double between(const Flown& a, const Flown& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.way.size(); ++i) sum += (a.way[i] - b.way[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.way.size()));
}

class DeadTime : public testing::TestWithParam<double> {};

TEST_P(DeadTime, CostsAtMostAThirdOfWhatItCostsUncompensated) {
  const double delay = GetParam();
  const std::pair<const char*, Path> paths[] = {{"circle", helix(8.0, 5.0, 0.0)},
                                                {"helix", helix(1.5, 1.5, 0.3)}};
  for (const auto& [name, path] : paths) {
    for (const std::string& law : kNames) {
      const double none = fly(law, path, {}, 0.0, 0.0).rms;
      const double without = fly(law, path, {}, delay, 0.0).rms;
      const double with = fly(law, path, {}, delay, delay).rms;
      RecordProperty(law + "_" + name,
                     std::to_string(none) + " " + std::to_string(without) + " " + std::to_string(with));
      EXPECT_GT(without, 1.04 * none) << law << ", " << name;
      EXPECT_LT(with - none, (without - none) / 3.0) << law << ", " << name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfMilliseconds, DeadTime, testing::Values(0.03, 0.047, 0.06, 0.1),
                         [](const auto& one) { return std::to_string(std::lround(1000.0 * one.param)); });

// A delay brings the foresight of a step nearer to its best, so the measure is the flight without one. Whole periods: else
// the decisions fall to other times after the step.
TEST(DeadTimeFlights, AStepIsFlownAsWithoutIt) {
  for (const std::string& law : kNames) {
    const Flown none = fly(law, step(), {}, 0.0, 0.0);
    for (const double delay : {0.03, 0.06, 0.1}) {
      const Flown without = fly(law, step(), {}, delay, 0.0), with = fly(law, step(), {}, delay, delay);
      EXPECT_LT(between(with, none), between(without, none) / 3.0) << law << ", " << delay;
    }
  }
}

TEST(DeadTimeFlights, NoiseDoesNotChangeThat) {
  PlantOptions noisy;
  noisy.position_noise = 0.005;
  noisy.velocity_noise = 0.02;
  noisy.attitude_noise = 0.005;
  const Path path = helix(8.0, 5.0, 0.0);
  for (const std::string& law : kNames) {
    const double none = fly(law, path, noisy, 0.0, 0.0).rms;
    EXPECT_LT(fly(law, path, noisy, 0.06, 0.06).rms - none,
              (fly(law, path, noisy, 0.06, 0.0).rms - none) / 3.0)
        << law;
  }
}

// A constant wind, a gain that is wrong and a loop that is not level: what is left is the trim's, which settles for long.
TEST(DeadTimeFlights, LeaveNoOffset) {
  PlantOptions plant;
  plant.wind = {1.0, -0.7, 0.5};
  plant.roll_gain = 1.0;
  plant.roll_offset = 0.03;
  const Path hover = [](double) { return Reference{}; };
  for (const std::string& law : kNames)
    EXPECT_LT(fly(switchOf(law, 0.06), hover, plant, 0.06, {}, 14.0).greatest, 4e-3) << law;
}

TEST(DeadTimeFlights, LostSamplesDoNotChangeWhatItBrings) {
  const Path path = helix(8.0, 5.0, 0.0);
  // Every third sample, and a quarter of a second twice. The vehicle keeps the last command.
  const OnSample lossy = [](int sample, std::unique_ptr<LawSwitch>&) {
    return sample % 3 != 1 && sample % 600 >= 25;
  };
  for (const std::string& law : kNames) {
    const double none = fly(switchOf(law, 0.0), path, {}, 0.0, lossy).rms;
    const double without = fly(switchOf(law, 0.0), path, {}, 0.06, lossy).rms;
    const double with = fly(switchOf(law, 0.06), path, {}, 0.06, lossy).rms;
    EXPECT_LT(with - none, (without - none) / 3.0) << law << " " << none << " " << without << " " << with;
  }
}

// In silence level commands are sent; they act after the delay as the others do.
TEST(DeadTimeFlights, GoesOnAfterSilence) {
  const Path path = helix(8.0, 5.0, 0.0);
  for (const std::string& law : kNames) {
    const auto silent = [](int sample) { return sample >= 800 && sample < 830; };
    const OnSample on_sample = [&](int sample, std::unique_ptr<LawSwitch>& laws) {
      if (silent(sample)) laws->onSilence(kPeriod * sample);
      return !silent(sample);
    };
    const Flown flown = fly(switchOf(law, 0.06), path, {}, 0.06, on_sample, 12.0);
    const Flown calm = fly(switchOf(law, 0.06), path, {}, 0.06, {}, 12.0);
    EXPECT_LT(flown.greatest, calm.greatest + 0.02) << law;
  }
}

TEST(DeadTimeFlights, MayBeToldInFlight) {
  const Path path = helix(8.0, 5.0, 0.0);
  for (const std::string& law : kNames) {
    const OnSample tell = [&](int sample, std::unique_ptr<LawSwitch>& laws) {
      if (sample != 800 && sample != 1400) return true;
      std::unique_ptr<LawSwitch> next = switchOf(law, sample == 800 ? 0.06 : 0.0);
      next->transferState(*laws);
      laws = std::move(next);
      return true;
    };
    const Flown told = fly(switchOf(law, 0.0), path, {}, 0.06, tell);
    const Flown never = fly(law, path, {}, 0.06, 0.0), always = fly(law, path, {}, 0.06, 0.06);
    EXPECT_LT(told.greatest, 1.2 * std::max(never.greatest, always.greatest)) << law;
    // Between the changes the flight comes to be that with the delay known.
    const auto apart = [&](const Flown& other, std::size_t sample) {
      return (told.way[sample] - other.way[sample]).norm();
    };
    EXPECT_LT(apart(always, 1399), 0.25 * apart(never, 1399)) << law;
  }
}

const std::vector<RegionMap>& robustMaps() {
  static const std::vector<RegionMap> kOnce = [] {
    std::vector<RegionMap> opened;
    for (const std::string axis : {"longitudinal", "lateral", "vertical"}) {
      const RobustProblem problem =
          parseRobustProblem(readText(problemFile("robust/aslquad_" + axis + ".yaml")), axis);
      const RoundedLaw rounded =
          roundLaw(problem, explicitLaw(problem, projectFeasibleSet(buildRobustProgram(problem))),
                   ExploreStatus::kComplete);
      const std::string path = testing::TempDir() + "dead_time_test_robust_" + axis + ".map";
      writeMap(encode(rounded.program, rounded.partition), path);
      opened.push_back(RegionMap::open(path));
    }
    return opened;
  }();
  return kOnce;
}

// Within what its maps are made for. Its inputs are held for 0.08 s, which a delay of 0.06 s does not divide.
TEST(DeadTimeFlights, TheRobustLawIsHelpedAlike) {
  const std::vector<RegionMap>& opened = robustMaps();
  PlantOptions plant;
  plant.mass = 0.65;
  plant.roll_time = plant.pitch_time = 0.2;
  const auto flight = [&](double delay, double told, const Path& path) {
    MultirotorOptions options;
    options.mass = plant.mass;
    options.delay = told;
    auto law = std::make_unique<MultirotorController>(
        std::array<const RegionMap*, 3>{&opened[0], &opened[1], &opened[2]}, options);
    return fly(std::make_unique<LawSwitch>(std::move(law), options), path, plant, delay);
  };
  const Path helical = helix(1.5, 0.8, 0.05);
  const double none = flight(0.0, 0.0, helical).rms, without = flight(0.06, 0.0, helical).rms;
  const double with = flight(0.06, 0.06, helical).rms;
  RecordProperty("robust", std::to_string(none) + " " + std::to_string(without) + " " + std::to_string(with));
  EXPECT_LT(with - none, (without - none) / 3.0) << none << " " << without << " " << with;
}

TEST(DeadTimeFlights, InactiveLawsTrackWithoutABump) {
  MultirotorOptions options;
  options.delay = 0.06;
  std::vector<std::unique_ptr<ControlLaw>> laws(lawTypes().size());
  const Law linear = lawOfName("linear"), nonlinear = lawOfName("nonlinear");
  laws[static_cast<std::size_t>(linear)] = lawOf("linear", options);
  laws[static_cast<std::size_t>(nonlinear)] = lawOf("nonlinear", options);
  const OnSample change = [&](int sample, std::unique_ptr<LawSwitch>& flown) {
    if (sample % 200 == 199) flown->select(sample % 400 < 200 ? nonlinear : linear);
    return true;
  };
  const Path path = helix(8.0, 5.0, 0.0);
  const Flown both =
      fly(std::make_unique<LawSwitch>(std::move(laws), linear, options), path, {}, 0.06, change);
  EXPECT_LT(both.greatest, 1.1 * fly("linear", path, {}, 0.06, 0.06).greatest);
}

TEST(DeadTimeFlights, TheStepDoesNotAllocate) {
  for (const std::string& law : kNames) {
    const Path path = helix(8.0, 5.0, 0.0);
    const std::unique_ptr<LawSwitch> laws = switchOf(law, 0.06);
    std::vector<Reference> preview(64);
    VehicleState state;
    state.position = path(0.0).position;
    long allocations = 0;
    for (int sample = 0; sample < 200; ++sample) {
      state.stamp = kPeriod * sample;
      for (std::size_t k = 0; k < preview.size(); ++k)
        preview[k] = path(state.stamp + laws->lead() + static_cast<double>(k) * laws->previewPeriod());
      const long before = polyfly_test::allocationCount();
      laws->step(state, preview.data());
      laws->prepare();
      if (sample % 50 == 49) laws->onSilence(state.stamp + 0.001);
      allocations += polyfly_test::allocationCount() - before;
    }
    EXPECT_EQ(allocations, 0) << law;
  }
}

TEST(DeadTimeOption, ComesFromTheProblemsUnlessItIsStated) {
  std::array<MpcProblem, 3> stated = problems();
  const auto lead = [&](double option) {
    MultirotorOptions options;
    options.delay = option;
    return LawSwitch(std::make_unique<MultirotorController>(stated, options), options).lead();
  };
  EXPECT_EQ(lead(0.0), 0.0);
  EXPECT_EQ(lead(0.06), 0.06);
  stated[0].delay = 0.05;
  EXPECT_EQ(lead(0.0), 0.05);
  stated[1].delay = 0.07;
  EXPECT_DOUBLE_EQ(lead(0.0), 0.06);
  EXPECT_EQ(lead(0.1), 0.1);
}

// Node and replay take their references from here.
TEST(DeadTimeOption, ReferencesAreThoseOfTheTimeOfTheCommand) {
  MultirotorOptions options;
  options.delay = 0.06;
  LawSwitch laws(lawOf("linear", options), options);
  FlightSupervisor flight(laws, options, FlightOptions{}, PilotRule::kNotRequired);
  std::vector<TrajectorySample> samples(2);
  samples[1].time = 10.0;
  for (TrajectorySample& sample : samples) {
    sample.position = {0.5 * sample.time, 0.0, 0.0};
    sample.velocity = {0.5, 0.0, 0.0};
    sample.has_velocity = true;
  }
  VehicleState state;
  flight.onOdometry(state, true);
  flight.onReference(ReferenceTrajectory(samples), 1.0);
  state.stamp = 2.0;
  state.position.x() = 0.5;
  flight.onOdometry(state, true);
  EXPECT_NEAR(flight.preview().front().position.x(), 0.53, 1e-9);
  EXPECT_NEAR(flight.wholePreview()[1].position.x(), 0.58, 1e-9);
}

}  // namespace
}  // namespace polyfly
