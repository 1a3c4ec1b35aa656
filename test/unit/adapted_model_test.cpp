// What the laws find of their models' errors, and what the disturbance's rate costs: where the model is true, in wind, after a
// push, and where something else is sent.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "compared_laws.hpp"
#include "polyfly_test/flight_figure.hpp"
#include "polyfly_test/multirotor_plant.hpp"
#include "polyfly_test/rigid_body_plant.hpp"

namespace polyfly {
namespace {

Path hover() {
  return [](double) {
    Reference reference;
    reference.position.z() = 1.0;
    return reference;
  };
}

/// RMS of the position error [m] in 15 s on the plant of Eq. 37, which the shipped models describe.
double flyModel(const Pilot& pilot, const Path& path, const PlantOptions& options) {
  PlantState start;
  start.position = path(0.0).position;
  start.thrust = options.gravity;
  MultirotorPlant plant(options, start);
  double sum = 0.0;
  constexpr int kSamples = 1500;
  for (int i = 0; i < kSamples; ++i) {
    plant.advance(pilot(plant.measure(), path));
    sum += (plant.truth().position - path(plant.time()).position).squaredNorm();
  }
  return std::sqrt(sum / kSamples);
}

/// Least and greatest ratio of the errors with these estimates and with a constant disturbance.
std::pair<double, double> ratiosOf(Estimates estimates, const Path& path, const PlantOptions& options) {
  constexpr Estimates kBefore = Estimates::kConstant;
  std::vector<double> ratios;
  for (const bool look_ahead : {true, false})
    ratios.push_back(flyModel(linearPilot(look_ahead, nullptr, estimates), path, options) /
                     flyModel(linearPilot(look_ahead, nullptr, kBefore), path, options));
  ratios.push_back(flyModel(nonlinearPilot(nullptr, estimates), path, options) /
                   flyModel(nonlinearPilot(nullptr, kBefore), path, options));
  const auto [least, greatest] = std::minmax_element(ratios.begin(), ratios.end());
  return {*least, *greatest};
}

PlantOptions noisy() {
  PlantOptions noise;
  noise.position_noise = 0.01;
  noise.velocity_noise = 0.05;
  noise.attitude_noise = 0.005;
  return noise;
}

Path steps() {
  return [](double time) {
    Reference reference;
    reference.position = {std::fmod(time, 10.0) < 5.0 ? 0.0 : 1.0, 0.0, 1.0};
    return reference;
  };
}

TEST(AdaptedModel, TheRateOfTheDisturbanceCostsLittleWhereTheModelIsTrue) {
  PlantOptions noise = noisy();
  EXPECT_LT(ratiosOf(Estimates::kRate, hover(), noise).second, 1.2);
  noise.gust_sigma.setConstant(0.5);
  EXPECT_LT(ratiosOf(Estimates::kRate, hover(), noise).second, 0.6);
  EXPECT_LT(ratiosOf(Estimates::kRate, helix(8.0, 5.0, 0.0), {}).second, 1.1);
  const auto [least, greatest] = ratiosOf(Estimates::kRate, steps(), {});
  EXPECT_GT(least, 0.99);
  EXPECT_LT(greatest, 1.01);
}

TEST(AdaptedModel, WhatTheLawsFindCostsLittleWhereTheModelIsTrue) {
  const Path circle = helix(8.0, 5.0, 0.0);
  PlantOptions noise = noisy();
  const auto greatestOf = [](const char* name, const Path& path, const PlantOptions& options) {
    const double ratio = ratiosOf(Estimates::kDefault, path, options).second;
    RecordProperty(name, std::to_string(ratio));
    return ratio;
  };
  EXPECT_LT(greatestOf("true_hover_noise", hover(), noise), 1.001);
  EXPECT_LT(greatestOf("true_circle", circle, {}), 1.1);
  EXPECT_LT(greatestOf("true_circle_noise", circle, noise), 1.05);
  noise.gust_sigma.setConstant(0.5);
  EXPECT_LT(greatestOf("true_hover_gusts", hover(), noise), 1.01);
  EXPECT_LT(greatestOf("true_circle_gusts", circle, noise), 1.0);
  const auto [least, greatest] = ratiosOf(Estimates::kDefault, steps(), {});
  EXPECT_GT(least, 0.999);
  EXPECT_LT(greatest, 1.001);
}

/// A hover in wind of a vehicle that is level under other commands than 0.
struct TrimmedHover {
  AttitudeCommand last;
  TiltAngles trim, level;  // [rad]
};

constexpr TiltAngles kTrim{0.03, -0.05};  // [rad]

TrimmedHover hoverInWind(ControlLaw& law) {
  PlantOptions options = noisy();
  options.wind = {1.0, -1.5, 0.3};
  PlantState start;
  start.position.z() = 1.0;
  start.thrust = options.gravity;
  MultirotorPlant plant(options, start);
  // The caller keeps the law.
  const Pilot pilot = pilotOf(std::shared_ptr<ControlLaw>(std::shared_ptr<ControlLaw>(), &law));
  TrimmedHover result;
  while (plant.time() < 30.0) {
    result.last = pilot(plant.measure(), hover());
    AttitudeCommand acting = result.last;
    acting.roll -= kTrim.roll;
    acting.pitch -= kTrim.pitch;
    plant.advance(acting);
  }
  result.trim = law.report().trim;
  result.level = law.report().level_trim;
  return result;
}

// What holds against the wind is constant, as a trim is: taken for the reference's tilt it would teach gain and lag.
TEST(AdaptedModel, AHoverInWindTeachesNothingAndFindsTheTrim) {
  for (const bool nonlinear : {false, true}) {
    const auto flown = [&](bool adapt_model) -> TrimmedHover {
      MultirotorOptions options;
      options.adapt_model = adapt_model;
      if (nonlinear) {
        NonlinearController law(options, {});
        return hoverInWind(law);
      }
      MultirotorController law(problemsWith(nullptr), options);
      return hoverInWind(law);
    };
    const TrimmedHover learning = flown(true), fixed = flown(false);
    EXPECT_NEAR(learning.trim.roll, kTrim.roll, 5e-3) << nonlinear;
    EXPECT_NEAR(learning.trim.pitch, kTrim.pitch, 5e-3) << nonlinear;
    EXPECT_EQ(learning.level.roll, learning.trim.roll) << nonlinear;
    EXPECT_EQ(learning.level.pitch, learning.trim.pitch) << nonlinear;
    // But for rounding.
    EXPECT_NEAR(learning.last.roll, fixed.last.roll, 1e-9) << nonlinear;
    EXPECT_NEAR(learning.last.pitch, fixed.last.pitch, 1e-9) << nonlinear;
    EXPECT_NEAR(learning.trim.roll, fixed.trim.roll, 1e-9) << nonlinear;
    EXPECT_NEAR(learning.trim.pitch, fixed.trim.pitch, 1e-9) << nonlinear;
  }
}

// As after a command of another law, which is tracked. Else the next sample would teach what the reference before was.
TEST(AdaptedModel, ACommandSentInsteadTeachesNothing) {
  const Path path = helix(8.0, 5.0, 0.0);
  NonlinearController replaced({}, {}), tracking({}, {});
  RigidBodyPlant plant({}, path(0.0).position);
  const auto fly = [&path](NonlinearController& law, const VehicleState& state) {
    std::vector<Reference> preview;
    for (int k = 0; k < law.previewLength(); ++k)
      preview.push_back(path(state.stamp + k * law.previewPeriod()));
    return law.step(state, preview.data()).command;
  };
  AttitudeCommand level;
  level.thrust = RigidBodyOptions{}.mass * MultirotorOptions{}.gravity;
  while (plant.time() < 8.0) {
    const AttitudeCommand command = fly(replaced, plant.measure());
    fly(tracking, plant.measure());
    plant.advance(command, kPeriod);
  }
  fly(replaced, plant.measure());
  replaced.sendInstead({plant.time(), ControlStatus::kLevel, ControlReason::kStale, level});
  tracking.track(plant.measure(), level);
  ASSERT_EQ(replaced.observer().drag(), tracking.observer().drag());
  EXPECT_GT(replaced.observer().drag().norm(), 0.1);
  plant.advance(level, kPeriod);
  fly(replaced, plant.measure());
  fly(tracking, plant.measure());
  EXPECT_EQ(replaced.observer().drag(), tracking.observer().drag());
}

// Else the published force would jump by the drag that was found.
TEST(AdaptedModel, WithoutAnAnswerThePublishedForceStays) {
  const Path path = helix(8.0, 5.0, 0.0);
  MultirotorController law(problemsWith(nullptr), {});
  RigidBodyPlant plant({}, path(0.0).position);
  while (plant.time() < 8.0) plant.advance(law.step(plant.measure(), path(plant.time())).command, kPeriod);
  const std::array<AxisReport, 3> before = law.report().axis;
  EXPECT_GT(std::hypot(before[0].disturbance, before[1].disturbance), 0.4);
  Reference none = path(plant.time());
  none.velocity.x() = std::nan("");
  EXPECT_EQ(law.step(plant.measure(), none).status, ControlStatus::kHoldLast);
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(law.report().axis[i].disturbance, before[i].disturbance);
}

// Where the reference rests nothing is learnt: the push of the demonstration, after its figure, leaves all parameters
// within the ranges that the maps hold.
TEST(AdaptedModel, APushInHoverLeavesTheParametersInTheirRanges) {
  FigureOptions figure;
  figure.hold_time = 15.0;
  const FlightFigure path(figure);
  PlantOptions options;
  options.wind = {0.4, -0.3, 0.0};
  options.gust_sigma = {0.03, 0.03, 0.02};
  options.gust_time = 2.0;
  options.kick = {4.5, -4.5, 7.0};
  options.kick_start = 35.5;
  options.kick_time = 0.4;
  options.position_noise = options.attitude_noise = 0.002;
  options.velocity_noise = options.angular_velocity_noise = 0.01;
  PlantState start;
  start.position = path.at(0.0).position;
  start.thrust = options.gravity;
  MultirotorPlant plant(options, start);
  const std::array<MpcProblem, 3> problems = problemsWith(nullptr);
  MultirotorOptions defaults;
  defaults.look_ahead = false;
  MultirotorController law(problems, defaults);
  int outside = 0;
  double fastest = 0.0;
  while (plant.time() < 45.0) {
    const VehicleState state = plant.measure();
    const ControlReport& report = law.step(state, path.at(state.stamp));
    for (std::size_t i = 0; i < problems.size(); ++i) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(report.axis[i].size); ++k) {
        const Signal& signal = problems[i].parameters[k].signal;
        const double value = report.axis[i].theta[k];
        outside += value < signal.lower || value > signal.upper ? 1 : 0;
      }
    }
    plant.advance(report.command);
    if (plant.time() > options.kick_start)
      fastest = std::max(fastest, plant.truth().velocity.head<2>().norm());
  }
  EXPECT_EQ(outside, 0);
  EXPECT_GT(fastest, 1.5);
}

}  // namespace
}  // namespace polyfly
