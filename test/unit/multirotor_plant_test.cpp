#include "polyfly_test/multirotor_plant.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <vector>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kRounding = 1e-11;       // accumulated rounding of some thousand substeps
constexpr double kRungeKutta = 1e-9;      // error of the fourth-order method with 1 ms substeps over seconds
constexpr double kReferenceError = 1e-6;  // error of the second-order reference with 0.1 ms steps

PlantState hovering(const PlantOptions& options) {
  PlantState state;
  state.thrust = options.gravity;
  return state;
}

AttitudeCommand command(double roll, double pitch, double yaw_rate, double thrust) {
  AttitudeCommand made;
  made.roll = roll;
  made.pitch = pitch;
  made.yaw_rate = yaw_rate;
  made.thrust = thrust;
  return made;
}

// A command that changes every period and keeps all axes busy.
AttitudeCommand manoeuvre(int period) {
  const double t = 0.01 * period;
  return command(0.3 * std::sin(2.0 * t), 0.25 * std::cos(1.3 * t), 0.8 * std::sin(0.7 * t),
                 1.52 * (9.8 + 2.0 * std::sin(3.0 * t)));
}

TEST(MultirotorPlant, HoversStill) {
  const PlantOptions options;
  MultirotorPlant plant(options, hovering(options));
  for (int i = 0; i < 1000; ++i) {
    plant.advance(command(0.0, 0.0, 0.0, options.mass * options.gravity));
  }
  EXPECT_NEAR(plant.time(), 10.0, kRounding);
  EXPECT_LT(plant.state().position.norm(), kRounding);
  EXPECT_LT(plant.state().velocity.norm(), kRounding);
}

TEST(MultirotorPlant, FreeFallKeepsItsEnergy) {
  PlantOptions options;
  options.thrust_min = 0.0;
  options.drag.setZero();
  PlantState start;
  start.position.z() = 100.0;
  start.velocity = Eigen::Vector3d(2.0, -1.0, 3.0);
  MultirotorPlant plant(options, start);
  const double energy = 0.5 * start.velocity.squaredNorm() + options.gravity * start.position.z();
  for (int i = 0; i < 300; ++i) {
    plant.advance(command(0.0, 0.0, 0.0, 0.0));
    const PlantState& state = plant.state();
    EXPECT_NEAR(0.5 * state.velocity.squaredNorm() + options.gravity * state.position.z(), energy,
                1e-12 * energy * (i + 1));
  }
  EXPECT_NEAR(plant.state().position.z(), 100.0 + 3.0 * 3.0 - 0.5 * options.gravity * 9.0, 1e-10);
  EXPECT_NEAR(plant.state().position.x(), 6.0, kRounding);
}

TEST(MultirotorPlant, DragGivesTheTerminalVelocity) {
  PlantOptions options;
  options.thrust_min = 0.0;
  options.drag = Eigen::Vector3d(0.4, 0.7, 1.5);
  options.wind = Eigen::Vector3d(1.2, -0.7, 0.0);
  MultirotorPlant plant(options, PlantState());
  const Eigen::Vector3d force = options.wind - Eigen::Vector3d(0.0, 0.0, options.gravity);
  for (int i = 1; i <= 3000; ++i) {
    plant.advance(command(0.0, 0.0, 0.0, 0.0));
    for (int axis = 0; axis < 3; ++axis) {
      const double closed_form =
          force[axis] / options.drag[axis] * (1.0 - std::exp(-options.drag[axis] * 0.01 * i));
      ASSERT_NEAR(plant.state().velocity[axis], closed_form, kRungeKutta);
    }
  }
  EXPECT_NEAR(plant.state().velocity.z(), -options.gravity / 1.5, kRungeKutta);
}

TEST(MultirotorPlant, LagsFollowTheirStepResponse) {
  PlantOptions options;
  options.yaw_rate_time = 0.3;
  options.thrust_time = 0.05;
  MultirotorPlant plant(options, hovering(options));
  const AttitudeCommand step = command(0.2, -0.1, 0.5, options.mass * 12.0);
  for (int i = 1; i <= 200; ++i) {
    plant.advance(step);
    const double t = 0.01 * i;
    const auto response = [t](double time) { return 1.0 - std::exp(-t / time); };
    EXPECT_NEAR(plant.state().roll, 0.9 * 0.2 * response(0.25), kRungeKutta);
    EXPECT_NEAR(plant.state().pitch, 0.9 * -0.1 * response(0.255), kRungeKutta);
    EXPECT_NEAR(plant.state().yaw_rate, 0.5 * response(0.3), kRungeKutta);
    EXPECT_NEAR(plant.state().yaw, 0.5 * (t - 0.3 * response(0.3)), kRungeKutta);
    EXPECT_NEAR(plant.state().thrust, 9.8066 + (12.0 - 9.8066) * response(0.05), 1e-7);
  }
}

// Eq. 37 once more, by rotation matrices and the midpoint rule.
struct ReferenceVehicle {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  Eigen::Vector3d rpy = Eigen::Vector3d::Zero();

  ReferenceVehicle rate(const PlantOptions& options, const AttitudeCommand& u) const {
    const Eigen::Matrix3d attitude = (Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX()))
                                         .toRotationMatrix();
    ReferenceVehicle dot;
    dot.p = v;
    dot.v = attitude * Eigen::Vector3d(0.0, 0.0, u.thrust / options.mass) -
            Eigen::Vector3d(0.0, 0.0, options.gravity) - Eigen::Vector3d(options.drag.asDiagonal() * v) +
            options.wind;
    dot.rpy = Eigen::Vector3d((options.roll_gain * u.roll - rpy[0]) / options.roll_time,
                              (options.pitch_gain * u.pitch - rpy[1]) / options.pitch_time, u.yaw_rate);
    return dot;
  }

  ReferenceVehicle plus(const ReferenceVehicle& dot, double h) const {
    ReferenceVehicle next;
    next.p = p + h * dot.p;
    next.v = v + h * dot.v;
    next.rpy = rpy + h * dot.rpy;
    return next;
  }
};

TEST(MultirotorPlant, AgreesWithAnIndependentIntegration) {
  PlantOptions options;
  options.drag = Eigen::Vector3d(0.1, 0.2, 0.05);
  options.wind = Eigen::Vector3d(0.5, -0.3, 0.1);
  MultirotorPlant plant(options, hovering(options));
  ReferenceVehicle reference;
  constexpr double kStep = 1e-4;
  for (int i = 0; i < 500; ++i) {
    plant.advance(manoeuvre(i));
    for (int k = 0; k < 100; ++k) {
      const ReferenceVehicle middle = reference.plus(reference.rate(options, manoeuvre(i)), 0.5 * kStep);
      reference = reference.plus(middle.rate(options, manoeuvre(i)), kStep);
    }
    ASSERT_LT((plant.state().position - reference.p).norm(), kReferenceError) << "after period " << i;
    ASSERT_LT((plant.state().velocity - reference.v).norm(), kReferenceError) << "after period " << i;
  }
  EXPECT_NEAR(plant.state().roll, reference.rpy[0], kReferenceError);
  EXPECT_NEAR(plant.state().pitch, reference.rpy[1], kReferenceError);
  EXPECT_NEAR(plant.state().yaw, reference.rpy[2], kReferenceError);
  EXPECT_GT(plant.state().position.norm(), 1.0) << "the manoeuvre does not move the vehicle";
}

Eigen::Vector3d endOfManoeuvre(double substep) {
  PlantOptions options;
  options.drag = Eigen::Vector3d(0.3, 0.3, 0.3);
  options.roll_time = 0.1;
  options.pitch_time = 0.12;
  options.period = 0.08;
  options.substep = substep;
  MultirotorPlant plant(options, hovering(options));
  for (int i = 0; i < 25; ++i) {
    plant.advance(manoeuvre(8 * i));
  }
  return plant.state().position;
}

TEST(MultirotorPlant, ConvergesWithTheFourthOrder) {
  const Eigen::Vector3d exact = endOfManoeuvre(0.001);
  const double coarse = (endOfManoeuvre(0.04) - exact).norm();
  const double fine = (endOfManoeuvre(0.02) - exact).norm();
  const double order = std::log2(coarse / fine);
  EXPECT_GT(order, 3.7);
  EXPECT_LT(order, 4.5);
}

PlantOptions noisy() {
  PlantOptions options;
  options.gust_sigma = Eigen::Vector3d(0.2, 0.3, 0.1);
  options.position_noise = 0.002;
  options.velocity_noise = 0.01;
  options.attitude_noise = 0.003;
  options.angular_velocity_noise = 0.02;
  options.seed = 7;
  return options;
}

// All that odometry tells of a flight.
std::vector<double> flight(const PlantOptions& options) {
  MultirotorPlant plant(options, hovering(options));
  std::vector<double> log;
  for (int i = 0; i < 100; ++i) {
    const VehicleState odometry = plant.measure();
    log.insert(log.end(), odometry.position.data(), odometry.position.data() + 3);
    log.insert(log.end(), odometry.velocity.data(), odometry.velocity.data() + 3);
    log.insert(log.end(), odometry.attitude.coeffs().data(), odometry.attitude.coeffs().data() + 4);
    log.insert(log.end(), odometry.angular_velocity.data(), odometry.angular_velocity.data() + 3);
    plant.advance(manoeuvre(i));
  }
  return log;
}

TEST(MultirotorPlant, TheSeedDecidesTheFlight) {
  PlantOptions options = noisy();
  const std::vector<double> first = flight(options);
  EXPECT_EQ(first, flight(options));
  options.seed = 8;
  EXPECT_NE(first, flight(options));
}

TEST(MultirotorPlant, NoiseHasItsStandardDeviation) {
  PlantOptions options = noisy();
  options.gust_sigma.setZero();
  MultirotorPlant plant(options, hovering(options));
  constexpr int kSamples = 4000;
  Eigen::Vector4d squares = Eigen::Vector4d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const VehicleState odometry = plant.measure();
    const VehicleState truth = plant.truth();
    const Eigen::AngleAxisd tilt(truth.attitude.inverse() * odometry.attitude);
    squares +=
        Eigen::Vector4d((odometry.position - truth.position).squaredNorm(),
                        (odometry.velocity - truth.velocity).squaredNorm(), tilt.angle() * tilt.angle(),
                        (odometry.angular_velocity - truth.angular_velocity).squaredNorm());
    EXPECT_NEAR(odometry.attitude.norm(), 1.0, kRounding);
  }
  const Eigen::Vector4d sigma = (squares / (3.0 * kSamples)).cwiseSqrt();
  constexpr double kShare = 0.03;  // 4.6 standard deviations of the estimate
  EXPECT_NEAR(sigma[0], options.position_noise, kShare * options.position_noise);
  EXPECT_NEAR(sigma[1], options.velocity_noise, kShare * options.velocity_noise);
  EXPECT_NEAR(sigma[2], options.attitude_noise, kShare * options.attitude_noise);
  EXPECT_NEAR(sigma[3], options.angular_velocity_noise, kShare * options.angular_velocity_noise);
}

TEST(MultirotorPlant, GustsAreGaussMarkov) {
  PlantOptions options;
  options.gust_sigma = Eigen::Vector3d(0.4, 0.4, 0.4);
  options.gust_time = 0.1;
  options.wind = Eigen::Vector3d(1.0, 2.0, 3.0);
  MultirotorPlant plant(options, hovering(options));
  std::vector<Eigen::Vector3d> gusts;
  for (int i = 0; i < 20000; ++i) {
    gusts.push_back(plant.disturbance() - options.wind);
    plant.advance(command(0.0, 0.0, 0.0, options.mass * options.gravity));
  }
  double variance = 0.0;
  double covariance = 0.0;
  const int lag = 10;  // one correlation time
  for (std::size_t i = lag; i < gusts.size(); ++i) {
    variance += gusts[i].squaredNorm();
    covariance += gusts[i].dot(gusts[i - lag]);
  }
  const double count = 3.0 * static_cast<double>(gusts.size() - lag);
  // 20000 samples hold about 1000 independent ones per axis.
  EXPECT_NEAR(variance / count, 0.16, 0.02);
  EXPECT_NEAR(covariance / variance, std::exp(-1.0), 0.08);
}

TEST(MultirotorPlant, AKickGivesItsImpulse) {
  PlantOptions options;
  options.drag.setZero();
  options.kick = Eigen::Vector3d(5.0, -2.0, 1.0);
  options.kick_start = 0.345;
  options.kick_time = 0.12;
  MultirotorPlant plant(options, hovering(options));
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(plant.disturbance().norm() > 0.0, i >= 35 && i <= 46) << i;
    plant.advance(command(0.0, 0.0, 0.0, options.mass * options.gravity));
  }
  EXPECT_LT((plant.state().velocity - 0.12 * options.kick).norm(), kRounding);
}

TEST(MultirotorPlant, ATumbleFallsAndTurnsAsItsRatesSay) {
  PlantOptions options;
  options.drag.setZero();
  options.period = 0.001;
  options.tumble_start = 0.1;
  options.tumble_time = 0.5;
  MultirotorPlant plant(options, hovering(options));
  const AttitudeCommand hover = command(0.0, 0.0, 0.0, options.mass * options.gravity);
  for (int i = 0; i < 100; ++i) plant.advance(hover);
  EXPECT_LT(plant.state().velocity.norm(), kRounding);
  plant.advance(hover);
  for (int i = 1; i < 499; ++i) {
    const VehicleState before = plant.measure();
    plant.advance(hover);
    const VehicleState after = plant.measure();
    const Eigen::AngleAxisd turn(before.attitude.conjugate() * after.attitude);
    const Eigen::Vector3d mean = 0.5 * (before.angular_velocity + after.angular_velocity);
    EXPECT_LT((turn.angle() * turn.axis() / options.period - mean).norm(), 1e-2) << i;
  }
  plant.advance(hover);
  EXPECT_LT((plant.state().velocity + 0.5 * options.gravity * Eigen::Vector3d::UnitZ()).norm(), 1e-9);
}

TEST(MultirotorPlant, CommandsActAfterTheirDelay) {
  PlantOptions options;
  MultirotorPlant prompt(options, hovering(options));
  options.command_delay = 0.013;
  options.period = 0.001;
  MultirotorPlant late(options, hovering(options));
  const AttitudeCommand step = command(0.2, 0.1, 0.3, options.mass * 11.0);
  for (int i = 0; i < 13; ++i) {
    late.advance(step);
    EXPECT_EQ(late.state().roll, 0.0);
    EXPECT_EQ(late.state().thrust, options.gravity);
  }
  for (int i = 0; i < 50; ++i) {
    prompt.advance(step);
  }
  for (int i = 0; i < 500; ++i) {
    late.advance(step);
  }
  EXPECT_NEAR(late.state().roll, prompt.state().roll, kRounding);
  EXPECT_NEAR((late.state().position - prompt.state().position).norm(), 0.0, kRounding);
}

TEST(MultirotorPlant, OdometryTellsTheDelayedState) {
  PlantOptions options;
  options.odometry_delay = 0.03;
  MultirotorPlant plant(options, hovering(options));
  std::vector<VehicleState> truths;
  for (int i = 0; i < 50; ++i) {
    truths.push_back(plant.truth());
    const VehicleState odometry = plant.measure();
    const VehicleState& then = truths[static_cast<std::size_t>(std::max(0, i - 3))];
    EXPECT_NEAR(odometry.stamp, 0.01 * i - 0.03, kRounding);
    EXPECT_EQ(odometry.position, then.position);
    EXPECT_EQ(odometry.attitude.coeffs(), then.attitude.coeffs());
    plant.advance(manoeuvre(i));
  }
}

TEST(MultirotorPlant, AngularVelocityIsTheRateOfTheAttitude) {
  PlantOptions options;
  options.period = 0.001;
  MultirotorPlant plant(options, hovering(options));
  // Error of the secant, of second order in the period [rad/s].
  constexpr double kSecant = 2e-5;
  const AttitudeCommand held = command(0.3, -0.2, 0.9, options.mass * 10.0);
  plant.advance(held);
  for (int i = 0; i < 2000; ++i) {
    const VehicleState before = plant.truth();
    plant.advance(held);
    const Eigen::AngleAxisd turn(before.attitude.inverse() * plant.truth().attitude);
    const Eigen::Vector3d rate = turn.angle() / options.period * turn.axis();
    const Eigen::Vector3d mean = 0.5 * (before.angular_velocity + plant.truth().angular_velocity);
    ASSERT_LT((rate - mean).norm(), kSecant);
  }
}

TEST(MultirotorPlant, CommandsAreCutToTheLimits) {
  PlantOptions options;
  MultirotorPlant plant(options, hovering(options));
  for (int i = 0; i < 500; ++i) {
    plant.advance(command(3.0, -3.0, 50.0, 1e6));
  }
  EXPECT_EQ(plant.saturatedCommands(), 500);
  EXPECT_NEAR(plant.state().roll, options.roll_gain * options.angle_max, 1e-8);
  EXPECT_NEAR(plant.state().pitch, -options.pitch_gain * options.angle_max, 1e-8);
  EXPECT_EQ(plant.state().yaw_rate, options.yaw_rate_max);
  EXPECT_EQ(plant.state().thrust, options.thrust_max);
}

TEST(MultirotorPlant, ACommandThatIsNotFiniteIsIgnored) {
  const PlantOptions options;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  MultirotorPlant plant(options, hovering(options));
  MultirotorPlant same(options, hovering(options));
  const AttitudeCommand good = command(0.1, 0.0, 0.0, options.mass * options.gravity);
  plant.advance(good);
  same.advance(good);
  plant.advance(command(nan, 0.0, 0.0, 10.0));
  same.advance(good);
  plant.advance(command(0.0, 0.0, 0.0, std::numeric_limits<double>::infinity()));
  same.advance(good);
  EXPECT_EQ(plant.ignoredCommands(), 2);
  EXPECT_EQ(plant.state().position, same.state().position);
  EXPECT_EQ(plant.state().roll, same.state().roll);
}

void expectRefused(const PlantOptions& options, const std::string& key) {
  try {
    MultirotorPlant plant(options, PlantState());
    FAIL() << key << " was accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(key), std::string::npos) << error.what();
  }
}

TEST(MultirotorPlant, BadOptionsAreRefusedByName) {
  PlantOptions options;
  options.mass = -1.0;
  expectRefused(options, "mass");
  options = PlantOptions();
  options.roll_time = std::numeric_limits<double>::quiet_NaN();
  expectRefused(options, "roll_time");
  options = PlantOptions();
  options.wind.y() = std::numeric_limits<double>::infinity();
  expectRefused(options, "wind");
  options = PlantOptions();
  options.thrust_min = 30.0;
  expectRefused(options, "thrust_min");
  options = PlantOptions();
  options.substep = 0.003;
  expectRefused(options, "period: must be a multiple of substep");
  options = PlantOptions();
  options.substep = 0.02;
  expectRefused(options, "substep");
  options = PlantOptions();
  options.command_delay = 0.0005;
  expectRefused(options, "command_delay");
  options = PlantOptions();
  options.odometry_delay = -0.01;
  expectRefused(options, "odometry_delay");

  PlantState start;
  start.roll = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(MultirotorPlant(PlantOptions(), start), Error);
}

}  // namespace
}  // namespace polyfly
