// What is learnt of an aircraft in flight: the filter against regression by normal equations, the observer on
// aircraft whose errors are known, and what it does to circles.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>

#include "fixedwing_lateral/lateral_observer.hpp"
#include "fixedwing_plant/flight_loop.hpp"
#include "fixedwing_plant/six_dof_aircraft.hpp"

namespace {

using namespace polyfly;

constexpr double kPeriod = 0.05;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

GainBiasOptions steady() {
  GainBiasOptions options;
  options.gain_deviation = 0.2;
  options.bias_deviation = 0.1;
  options.noise = 0.05;
  options.gain_most = 10.0;
  options.bias_most = 10.0;
  return options;
}

TEST(GainBiasFilter, IsTheRegressionWithItsPrior) {
  const GainBiasOptions options = steady();
  GainBiasFilter filter(options);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  // The same as rows of least squares: gain = 1 and bias = 0 with their weights, then the data.
  Eigen::Matrix2d normal_matrix = Eigen::Matrix2d::Zero();
  normal_matrix(0, 0) = std::pow(options.gain_deviation, -2);
  normal_matrix(1, 1) = std::pow(options.bias_deviation, -2);
  Eigen::Vector2d right(normal_matrix(0, 0), 0.0);
  for (int i = 0; i < 100; ++i) {
    const double x = normal(random);
    const double y = 0.9 * x + 0.03 + 0.05 * normal(random);
    filter.update(x, y, 1.0);
    const Eigen::Vector2d row(x, 1.0);
    normal_matrix += row * row.transpose() / std::pow(options.noise, 2);
    right += row * y / std::pow(options.noise, 2);
    const Eigen::Vector2d expected = normal_matrix.inverse() * right;
    ASSERT_NEAR(filter.gain(), expected[0], 1e-9);
    ASSERT_NEAR(filter.bias(), expected[1], 1e-9);
  }
}

TEST(GainBiasFilter, StaysWithinItsBoundsAndLeavesOutWhatIsNoNumber) {
  GainBiasOptions options = steady();
  options.gain_drift = 0.02;
  options.bias_drift = 0.01;
  options.gain_most = 0.3;
  options.bias_most = 0.05;
  GainBiasFilter filter(options);
  filter.update(kNan, 1.0, 1.0);
  filter.update(1.0, std::numeric_limits<double>::infinity(), 1.0);
  EXPECT_EQ(filter.gain(), 1.0);
  EXPECT_EQ(filter.bias(), 0.0);
  for (int i = 0; i < 50; ++i) {
    filter.update(0.5, 50.0, 1.0);
    EXPECT_LE(filter.gain(), 1.3);
    EXPECT_LE(filter.bias(), 0.05);
  }
  for (int i = 0; i < 200; ++i) filter.update(i % 2 == 0 ? 0.5 : -0.5, i % 2 == 0 ? 0.5 : -0.5, 1.0);
  EXPECT_NEAR(filter.gain(), 1.0, 0.05);
  EXPECT_NEAR(filter.bias(), 0.0, 0.01);
}

TEST(GainBiasFilter, FollowsAChangeAfterALongTimeWithoutOne) {
  GainBiasOptions options = steady();
  options.gain_drift = 0.02;
  options.bias_drift = 0.01;
  GainBiasFilter filter(options);
  for (int i = 0; i < 3600; ++i) filter.update(0.0, 0.0, 1.0);
  filter.update(1.0, 4.0, 1.0);  // one wild value after an hour does not count alone
  EXPECT_LT(filter.gain() + filter.bias(), 4.0);
  for (int i = 0; i < 100; ++i) filter.update(i % 2 == 0 ? 1.0 : -1.0, i % 2 == 0 ? 0.85 : -0.75, 1.0);
  EXPECT_NEAR(filter.gain(), 0.8, 0.03);
  EXPECT_NEAR(filter.bias(), 0.05, 0.02);
}

/// Swings to both sides, holding each roll for four seconds.
LateralObserver learnt(Aircraft& aircraft, double duration) {
  LateralObserver observer{LateralModel{}};
  observer.update(aircraft.state(), aircraft.airspeed(), 0.0);
  for (int i = 0; i * kPeriod < duration; ++i) {
    const double reference = 0.4 * ((i / 80) % 4 - 1.5) / 1.5;
    aircraft.fly(reference, kPeriod);
    observer.update(aircraft.state(), aircraft.airspeed(), reference);
  }
  return observer;
}

TEST(LateralObserver, LearnsNothingFromTheModelItself) {
  ChapterAircraft aircraft(LateralModel{}, {}, 14.0, {3.0, -2.0});
  const LateralObserver observer = learnt(aircraft, 120.0);
  EXPECT_NEAR(observer.rollBias(), 0.0, 1e-3);
  EXPECT_NEAR(observer.turnGain(), 1.0, 2e-3);
  EXPECT_NEAR(observer.turnBias(), 0.0, 1e-3);
}

TEST(LateralObserver, DoesNotMindWhereAHeadingIsWrapped) {
  PerturbedAircraft aircraft(RoughOptions{}, {}, 1);
  LateralObserver counted{LateralModel{}};
  LateralObserver wrapped{LateralModel{}};
  for (int i = 0; i < 4000; ++i) {  // round and round
    AircraftState state = aircraft.state();
    counted.update(state, aircraft.airspeed(), 0.4);
    state.heading = wrapCourse(state.heading);
    wrapped.update(state, aircraft.airspeed(), 0.4);
    aircraft.fly(0.4, kPeriod);
  }
  EXPECT_GT(aircraft.state().heading, 4.0 * kPi);
  EXPECT_NEAR(wrapped.turnGain(), counted.turnGain(), 1e-9);
  EXPECT_NEAR(wrapped.turnBias(), counted.turnBias(), 1e-9);
}

TEST(LateralObserver, LearnsTheErrorsOfAnAircraft) {
  RoughOptions options;
  options.roll_trim = 0.04;
  options.turn_gain = 0.9;
  options.turn_lag = 0.05;  // a long one, in swings, looks like a loss of gain
  options.load_drag = 0.0;
  PerturbedAircraft aircraft(options, {}, 1);
  const LateralObserver observer = learnt(aircraft, 300.0);
  const LateralModel model;
  EXPECT_NEAR(observer.rollBias(), model.a0 / model.b0 * options.roll_trim, 0.01);
  EXPECT_NEAR(observer.turnGain(), options.turn_gain, 0.02);
  EXPECT_NEAR(observer.turnBias(), 0.0, 0.005);
}

TEST(LateralObserver, DoesNotLearnFromReferencesThatWereNotFlown) {
  ChapterAircraft aircraft(LateralModel{}, {}, 14.0, {0.0, 0.0});
  LateralObserver observer{LateralModel{}};
  for (int i = 0; i < 2000; ++i) {
    observer.interrupt();
    observer.update(aircraft.state(), aircraft.airspeed(), 0.5);  // while a pilot flies level
    aircraft.fly(0.0, kPeriod);
  }
  EXPECT_EQ(observer.rollBias(), 0.0);
  AircraftState back = aircraft.state();
  for (int i = 0; i < 100; ++i) {  // a clock that runs backwards, and one with gaps
    back.stamp += i % 2 == 0 ? -0.1 : 0.35;
    observer.update(back, 14.0, 0.5);
  }
  EXPECT_EQ(observer.rollBias(), 0.0);
}

TEST(LateralObserver, DoesNotLearnFromAPilotOfWhomNobodyToldIt) {
  ChapterAircraft aircraft(LateralModel{}, {}, 14.0, {0.0, 0.0});
  LateralObserver observer{LateralModel{}};
  for (int i = 0; i < 2000; ++i) {
    observer.update(aircraft.state(), aircraft.airspeed(), -0.2);
    aircraft.fly(0.35 + 0.1 * std::sin(0.01 * i), kPeriod);
  }
  EXPECT_LT(std::abs(observer.rollBias()), 0.01);
  EXPECT_NEAR(observer.turnGain(), 1.0, 0.01);  // how it turns is seen whoever flies
}

TEST(LateralObserver, DoesNotLearnFromAHeadingThatIsSetAnew) {
  ChapterAircraft aircraft(LateralModel{}, {}, 14.0, {0.0, 0.0});
  LateralObserver observer{LateralModel{}};
  for (int i = 0; i < 2000; ++i) {
    AircraftState state = aircraft.state();
    const int jumps = i / 100;  // one every five seconds
    state.heading += jumps * 0.8;
    observer.update(state, aircraft.airspeed(), 0.3);
    aircraft.fly(0.3, kPeriod);
  }
  EXPECT_NEAR(observer.turnGain(), 1.0, 0.01);
  EXPECT_NEAR(observer.turnBias(), 0.0, 0.002);
}

/// A loiter by the guidance; (mean, largest) distance from the circle once it settled [m].
std::pair<double, double> flyCircle(Aircraft& aircraft, bool learn, double radius, TurnDirection direction) {
  GuidanceOptions options;
  // As published: the weaker it is, the more of an offset the estimate has to take.
  options.weights.track = LateralWeights{}.track;
  options.learns_disturbance = learn;
  LateralGuidance guidance(options, "test");
  guidance.setMission(makeMission({LoiterCircle{{0.0, 0.0}, radius, direction}}, {}, "test"));
  Sensors sensors({}, 1);
  double sum = 0.0;
  double largest = 0.0;
  int count = 0;
  for (const FlightSample& sample : flyLaw(aircraft, sensors, lawOf(guidance), kPeriod, 180.0)) {
    if (sample.time < 90.0) continue;
    sum += sample.output.error.track;
    largest = std::max(largest, std::abs(sample.output.error.track));
    ++count;
  }
  return {sum / count, largest};
}

TEST(LateralObserver, TakesTheSteadyOffsetFromCircles) {
  for (const TurnDirection direction : {TurnDirection::kLeft, TurnDirection::kRight}) {
    SixDofOptions options;
    options.aileron_trim = 0.03;
    SixDofAircraft without(options, {}, 1), with(options, {}, 1);
    const double offset = std::abs(flyCircle(without, false, 60.0, direction).first);
    EXPECT_GT(offset, 0.8);
    EXPECT_LT(std::abs(flyCircle(with, true, 60.0, direction).first), 0.4);
  }
}

TEST(LateralObserver, WindsNothingUpWhereTheReferenceIsAtItsBound) {
  // A circle that asks for more roll than is allowed, for minutes; then one that does not.
  SixDofAircraft aircraft(SixDofOptions{}, {}, 1);
  const GuidanceOptions options;
  LateralGuidance guidance(options, "test");
  Sensors sensors({}, 1);
  const auto fly = [&](double radius, double duration) {
    guidance.setMission(makeMission({LoiterCircle{{0.0, 0.0}, radius, TurnDirection::kRight}}, {}, "test"));
    return flyLaw(aircraft, sensors, lawOf(guidance), kPeriod, duration);
  };
  int at_bound = 0;
  double bias_largest = 0.0;
  for (const FlightSample& sample : fly(20.0, 180.0)) {
    at_bound += sample.roll_reference > 0.61 ? 1 : 0;
    EXPECT_LT(std::abs(sample.output.roll_bias), 0.05);
    bias_largest = std::max(bias_largest, std::abs(sample.output.turn_bias));
  }
  EXPECT_GT(at_bound, 1800);
  EXPECT_LT(bias_largest, 0.03);
  // What it learnt is how the aircraft turns, not how far it is from the path.
  const AircraftState before = aircraft.state();
  aircraft.fly(options.limits.roll_reference, 1.0);
  const double turned = aircraft.state().heading - before.heading;
  const GuidanceOutput& learnt_last = guidance.update(sensors.measure(aircraft, kPeriod));
  const double predicted = learnt_last.turn_gain * 9.81 * std::tan(before.roll) / aircraft.airspeed();
  EXPECT_NEAR(predicted + learnt_last.turn_bias, turned, 0.03 * turned);
  const std::vector<FlightSample> after = fly(100.0, 60.0);
  double late = 0.0;
  for (const FlightSample& sample : after) {
    if (sample.time > after.front().time + 30.0) late = std::max(late, std::abs(sample.output.error.track));
  }
  EXPECT_LT(late, 1.0);
}

}  // namespace
