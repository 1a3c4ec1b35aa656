// The simulated aircraft in six degrees of freedom against mechanics, and the gusts against the spectra of
// the Dryden model.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "fixedwing_plant/six_dof_aircraft.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kGravity = 9.81;

SixDofOptions inCalmWithoutErrors() {
  SixDofOptions options;
  options.aileron_trim = 0.0;
  options.roll_mounting = 0.0;
  return options;
}

TEST(Airframe, IsInTrimByForcesAndMoments) {
  const Airframe airframe;
  for (const double airspeed : {12.0, 14.0, 18.0}) {
    const Trim trim = trimLevel(airframe, airspeed);
    EXPECT_LT(trim.residual, 1e-9);
    EXPECT_GT(trim.controls.throttle, 0.2);
    EXPECT_LT(trim.controls.throttle, 1.0);
    EXPECT_LT(std::abs(trim.controls.elevator), airframe.deflection_max);
    // Lift, drag and thrust by the published polynomials alone.
    const double a = trim.alpha;
    const double pressure = 0.5 * airframe.density * airspeed * airspeed * airframe.area;
    const double lift = pressure * (0.2127 + 10.8060 * a - 46.8324 * a * a + 60.6017 * a * a * a);
    const double drag = pressure * (0.1360 - 0.6737 * a + 5.4546 * a * a);
    const double thrust = 14.7217 * trim.controls.throttle;
    EXPECT_NEAR(lift + thrust * std::sin(a), airframe.mass * kGravity, 1e-6);
    EXPECT_NEAR(drag, thrust * std::cos(a), 1e-6);
    EXPECT_NEAR(0.0435 - 2.9690 * a - 6.1308 * trim.controls.elevator, 0.0, 1e-9);
  }
}

TEST(Airframe, StaysInTrimWithoutItsAutopilot) {
  const Airframe airframe;
  const Trim trim = trimLevel(airframe, 14.0);
  BodyState state;
  state.velocity = 14.0 * Vector3d(std::cos(trim.alpha), 0.0, std::sin(trim.alpha));
  state.attitude = attitudeOf(0.0, trim.alpha, 0.3);
  for (int i = 0; i < 2000; ++i) state = advance(airframe, state, trim.controls, {}, 0.005);
  EXPECT_NEAR(state.position.z(), 0.0, 1e-3);
  EXPECT_NEAR(state.position.head<2>().norm(), 140.0, 1e-3);
  EXPECT_LT(state.rates.norm(), 1e-6);
}

TEST(Airframe, KeepsMomentumAndEnergyWithoutAir) {
  Airframe airframe;
  airframe.density = 0.0;
  airframe.thrust_max = 0.0;
  BodyState state;
  state.velocity = {12.0, 1.0, -3.0};
  state.attitude = attitudeOf(0.4, 0.2, -1.0);
  state.rates = {2.0, -1.0, 1.5};
  const auto momentum = [&] { return Vector3d(state.attitude * (airframe.inertiaTensor() * state.rates)); };
  const auto energy = [&] {
    return 0.5 * airframe.mass * state.velocity.squaredNorm() +
           0.5 * state.rates.dot(airframe.inertiaTensor() * state.rates) -
           airframe.mass * kGravity * state.position.z();
  };
  const Vector3d momentum_before = momentum();
  const double energy_before = energy();
  const Vector3d velocity_before = state.attitude * state.velocity;
  for (int i = 0; i < 1000; ++i) state = advance(airframe, state, {}, {}, 0.005);
  EXPECT_LT((momentum() - momentum_before).norm(), 1e-6);
  EXPECT_NEAR(energy(), energy_before, 1e-5 * energy_before);
  const Vector3d fallen = velocity_before * 5.0 + Vector3d(0.0, 0.0, 0.5 * kGravity * 25.0);
  EXPECT_LT((state.position - fallen).norm(), 1e-6);
}

TEST(Airframe, GainsTheEnergyThatAirAndThrustGive) {
  const Airframe airframe;
  SixDofAircraft aircraft(inCalmWithoutErrors(), {}, 1);
  constexpr double kStep = 0.005;
  double work = 0.0;
  double before = 0.0;
  double travelled = 0.0;  // work of the forces without its sign
  const auto energy = [&] {
    const BodyState& state = aircraft.body();
    return 0.5 * airframe.mass * state.velocity.squaredNorm() +
           0.5 * state.rates.dot(airframe.inertiaTensor() * state.rates) -
           airframe.mass * kGravity * state.position.z();
  };
  const auto power = [&] {
    const BodyState& state = aircraft.body();
    const Wrench wrench = wrenchOf(airframe, state.velocity, state.rates, aircraft.controls());
    return wrench.force.dot(state.velocity) + wrench.moment.dot(state.rates);
  };
  before = energy();
  double last = power();
  for (int i = 0; i < 4000; ++i) {  // turns this way and that
    aircraft.fly((i / 600) % 2 == 0 ? 0.5 : -0.4, kStep);
    const double now = power();
    work += 0.5 * kStep * (last + now);
    travelled += 0.5 * kStep * std::abs(last + now);
    last = now;
  }
  EXPECT_GT(travelled, 50.0);
  EXPECT_NEAR(energy() - before, work, 0.02 * travelled);
}

TEST(SixDof, TurnsOnTheCircleThatItsForcesAskFor) {
  for (const double roll : {-0.5, -0.25, 0.25, 0.5}) {
    SixDofAircraft aircraft(inCalmWithoutErrors(), {}, 1);
    aircraft.fly(roll, 60.0);
    const BodyState state = aircraft.body();
    const AircraftState begin = aircraft.state();
    EXPECT_NEAR(begin.roll, roll, 0.05);
    EXPECT_LT(std::abs(aircraft.body().rates.x()), 0.05);
    aircraft.fly(roll, 1.0);
    const AircraftState end = aircraft.state();
    const double turn = end.heading - begin.heading;
    const double speed = end.ground_velocity.norm();
    // The force towards the centre of the turn by the aerodynamics alone.
    const Airframe airframe;
    const Wrench wrench = wrenchOf(airframe, state.velocity, state.rates, aircraft.controls());
    const Vector3d force = state.attitude * wrench.force;
    const Vector2d right(-begin.ground_velocity.y(), begin.ground_velocity.x());
    const double towards = force.head<2>().dot(right) / right.norm();
    EXPECT_NEAR(airframe.mass * speed * turn, towards, 0.02 * std::abs(towards));
    // Coordinated it would be this; the slip makes it wider, but not much.
    const double coordinated = kGravity * std::tan(begin.roll) / speed;
    EXPECT_LT(std::abs(turn), 0.995 * std::abs(coordinated));
    EXPECT_GT(std::abs(turn), 0.8 * std::abs(coordinated));
    EXPECT_GT(std::abs(aircraft.slip()), 0.005);
  }
}

TEST(SixDof, HoldsAltitudeAndAirspeedAndGivesWayInTurns) {
  SixDofAircraft aircraft(inCalmWithoutErrors(), {}, 1);
  aircraft.fly(0.0, 20.0);
  EXPECT_NEAR(aircraft.altitude(), 80.0, 0.05);
  EXPECT_NEAR(aircraft.airspeed(), 14.0, 0.05);
  EXPECT_NEAR(aircraft.state().position.y(), 0.0, 0.01);
  double lowest = 80.0;
  double change = 0.0;
  for (int i = 0; i < 400; ++i) {
    aircraft.fly(0.6, 0.1);
    lowest = std::min(lowest, aircraft.altitude());
    change = std::max(change, std::abs(aircraft.airspeed() - 14.0));
  }
  EXPECT_LT(lowest, 79.8);
  EXPECT_GT(lowest, 70.0);
  EXPECT_GT(change, 0.1);
  EXPECT_LT(change, 3.0);
  EXPECT_NEAR(aircraft.altitude(), 80.0, 1.0);
  EXPECT_NEAR(aircraft.airspeed(), 14.0, 0.2);
}

TEST(SixDof, HasTheTrimErrorsThatItIsGiven) {
  SixDofOptions options;
  SixDofAircraft aircraft(options, {}, 1);
  aircraft.fly(0.0, 20.0);
  const double measured = aircraft.state().roll;
  // The warped wing causes a roll error, and nothing integrates it away.
  EXPECT_GT(measured, 0.005);
  EXPECT_NEAR(measured - eulerAngles(aircraft.body().attitude).x(), options.roll_mounting, 1e-12);
}

TEST(SixDof, MovesWithTheWindAndNotThroughIt) {
  SixDofOptions options = inCalmWithoutErrors();
  SixDofAircraft calm(options, {}, 1);
  options.wind = {3.0, -5.0};
  SixDofAircraft windy(options, {}, 1);
  for (int i = 0; i < 300; ++i) {
    calm.fly(0.3 * std::sin(0.05 * i), 0.1);
    windy.fly(0.3 * std::sin(0.05 * i), 0.1);
  }
  EXPECT_LT((windy.state().position - calm.state().position - 30.0 * options.wind).norm(), 1e-6);
  EXPECT_NEAR(windy.airspeed(), calm.airspeed(), 1e-8);
}

TEST(SixDof, IsTheSameEveryTimeAndAnotherWithAnotherSeed) {
  SixDofOptions options;
  options.turbulence = 7.0;
  SixDofAircraft one(options, {}, 4), same(options, {}, 4), other(options, {}, 5);
  for (SixDofAircraft* aircraft : {&one, &same, &other}) aircraft->fly(0.2, 5.0);
  EXPECT_EQ(one.state().position, same.state().position);
  EXPECT_NE(one.state().position, other.state().position);
}

// A long record of gusts at one airspeed.
std::vector<Vector3d> gustsOf(const DrydenOptions& options, double airspeed, double step, int count) {
  DrydenGusts gusts(options, 3);
  std::vector<Vector3d> record;
  for (int i = 0; i < count; ++i) {
    gusts.step(airspeed, step);
    record.push_back(gusts.velocity());
  }
  return record;
}

TEST(Dryden, HasTheVarianceAndTheMemoryOfTheModel) {
  DrydenOptions options;
  options.deviation = {1.5, 1.0, 0.5};
  options.scale = {20.0, 20.0, 10.0};
  constexpr double kAirspeed = 14.0;
  constexpr double kStep = 0.1;
  constexpr int kCount = 400000;
  const auto record = gustsOf(options, kAirspeed, kStep, kCount);
  for (const int lag : {0, 5, 10, 20}) {
    Vector3d sum = Vector3d::Zero();
    for (int i = 0; i + lag < kCount; ++i) sum += record[i].cwiseProduct(record[i + lag]);
    sum /= kCount - lag;
    for (int axis = 0; axis < 3; ++axis) {
      const double x = kAirspeed / options.scale[axis] * kStep * lag;
      const double theory = std::exp(-x) * (axis == 0 ? 1.0 : 1.0 - 0.5 * x);
      EXPECT_NEAR(sum[axis] / std::pow(options.deviation[axis], 2), theory, 0.03) << lag << ": " << axis;
    }
  }
}

// Averaged periodograms against sigma^2 2L/(pi V) / (1 + (L w / V)^2) and
// sigma^2 L/(pi V) (1 + 3 (L w / V)^2) / (1 + (L w / V)^2)^2, whose integrals over all w > 0 are sigma^2.
TEST(Dryden, HasTheSpectrumOfTheModel) {
  DrydenOptions options;
  options.deviation = {1.5, 1.0, 0.5};
  options.scale = {60.0, 60.0, 30.0};
  constexpr double kAirspeed = 14.0;
  constexpr double kStep = 0.02;
  constexpr int kWindow = 8192;
  constexpr int kWindows = 150;
  const auto record = gustsOf(options, kAirspeed, kStep, kWindow * kWindows);
  for (const int bin : {4, 10, 25, 60, 150}) {
    const double omega = 2.0 * kPi * bin / (kWindow * kStep);
    Vector3d power = Vector3d::Zero();
    for (int w = 0; w < kWindows; ++w) {
      Eigen::Vector3cd sum = Eigen::Vector3cd::Zero();
      const std::complex<double> turn = std::polar(1.0, -omega * kStep);
      std::complex<double> phase = 1.0;
      for (int i = 0; i < kWindow; ++i, phase *= turn)  // Hann
        sum += (0.5 - 0.5 * std::cos(2.0 * kPi * i / kWindow)) * phase * record[w * kWindow + i];
      power += sum.cwiseAbs2();
    }
    power *= kStep / (kPi * 0.375 * kWindow * kWindows);  // one-sided, by radian per second
    for (int axis = 0; axis < 3; ++axis) {
      const double x = options.scale[axis] * omega / kAirspeed;
      const double unit = std::pow(options.deviation[axis], 2) * options.scale[axis] / (kPi * kAirspeed);
      const double theory =
          unit * (axis == 0 ? 2.0 / (1.0 + x * x) : (1.0 + 3.0 * x * x) / std::pow(1.0 + x * x, 2));
      EXPECT_NEAR(power[axis] / theory, 1.0, 0.25) << omega << " rad/s: " << axis;  // 3 standard errors
    }
  }
}

TEST(Dryden, HasTheStrengthsAndLengthsOfTheSpecificationNearTheGround) {
  // 1000 feet: the lengths are 1000 feet and the three deviations the same; 10 feet by hand.
  const DrydenOptions high = lowAltitudeDryden(304.8, 10.0, 2.6);
  EXPECT_NEAR(high.scale.x(), 304.8, 0.5);
  EXPECT_NEAR(high.deviation.x(), 1.0, 1e-3);
  EXPECT_NEAR(high.deviation.z(), 1.0, 1e-12);
  const DrydenOptions low = lowAltitudeDryden(3.048, 10.0, 2.6);
  EXPECT_NEAR(low.scale.x(), 3.048 * std::pow(0.18523, -1.2), 1e-3);
  EXPECT_NEAR(low.deviation.x(), std::pow(0.18523, -0.4), 1e-3);
  EXPECT_EQ(lowAltitudeDryden(80.0, 0.0, 2.6).deviation.norm(), 0.0);
  // The roll gusts: the spectrum of p of the specification, integrated by the midpoint rule.
  constexpr double kAirspeed = 14.0;
  double variance = 0.0;
  const double width = 4.0 * high.span / (kPi * kAirspeed);
  for (double omega = 0.005; omega < 20000.0; omega *= 1.01) {
    const double at = omega * 1.005;
    variance += 0.01 * omega / (kAirspeed * high.scale.z()) * 0.8 *
                std::cbrt(kPi * high.scale.z() / (4.0 * high.span)) / (1.0 + std::pow(width * at, 2));
  }
  EXPECT_NEAR(high.roll_deviation, std::sqrt(variance), 0.01 * high.roll_deviation);
}

}  // namespace
