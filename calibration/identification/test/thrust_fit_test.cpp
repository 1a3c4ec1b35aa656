#include "identification/thrust_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "made_thrust.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

using test::MadeThrust;

ThrustFit fitFlights(const MadeThrust& made, const std::vector<FlightSignals>& flights, int degree = 0) {
  ThrustOptions options;
  options.mass = made.mass;
  options.degree = degree;
  return fitThrust({flights, std::vector<std::vector<TimeWindow>>(flights.size())}, options);
}

double meanCommand(const std::vector<FlightSignals>& flights) {
  double sum = 0.0, count = 0.0;
  for (const FlightSignals& flight : flights) {
    const std::vector<double>& values = flight.at("thrust_cmd").value;
    sum = std::accumulate(values.begin(), values.end(), sum);
    count += static_cast<double>(values.size());
  }
  return sum / count;
}

double polynomialAt(const std::vector<double>& coefficients, double thrust) {
  double value = 0.0;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) value = value * thrust + *c;
  return value;
}

const FittedParameter& parameterOf(const ThrustFit& fit, const std::string& name) {
  const auto found = std::find_if(fit.parameters.begin(), fit.parameters.end(),
                                  [&name](const FittedParameter& one) { return one.name == name; });
  if (found == fit.parameters.end()) throw Error("no parameter " + name);
  return *found;
}

bool holds(const FittedParameter& parameter, double truth) {
  return parameter.least() <= truth && truth <= parameter.greatest();
}

bool mentions(const std::vector<std::string>& sentences, const std::string& words) {
  return std::any_of(sentences.begin(), sentences.end(), [&words](const std::string& sentence) {
    return sentence.find(words) != std::string::npos;
  });
}

// A vehicle of any size, quadratic or cubic, with the command at hover between 0.35 and 0.6.
MadeThrust someVehicle(std::mt19937& random) {
  const auto between = [&random](double least, double greatest) {
    return std::uniform_real_distribution<double>(least, greatest)(random);
  };
  MadeThrust made;
  made.mass = between(0.5, 4.0);
  const double weight = made.mass * 9.8066;
  const double hover = between(0.35, 0.6), idle = between(0.05, 0.15), bend = between(0.1, 0.35);
  const double twist = random() % 2 == 0 ? 0.0 : between(0.05, 0.1);
  // idle + (hover - idle) (x (1 + bend) - bend x^2 + twist x (x - 1) (x - 2)) with x = F / weight.
  const double rise = hover - idle;
  made.curve = {idle, rise * (1.0 + bend + 2.0 * twist) / weight,
                rise * (-bend - 3.0 * twist) / (weight * weight), rise * twist / (weight * weight * weight)};
  made.lag = between(0.02, 0.1);
  made.delay = between(0.0, 0.04);
  made.drag = between(0.0, 0.3);
  made.exponent = between(0.0, 2.0);
  made.sag = between(0.0, 1.0);
  made.gust = between(0.0, 0.4);
  made.noise = between(0.1, 0.8);
  made.excitation = between(0.15, 0.25);
  made.duration = 40.0;
  return made;
}

TEST(ThrustFit, IntervalsHoldTheCommandsOfHiddenVehicles) {
  std::mt19937 random(7);
  int inside = 0, all = 0, supported = 0;
  constexpr int kVehicles = 20;
  for (std::uint32_t seed = 1; seed <= kVehicles; ++seed) {
    const MadeThrust made = someVehicle(random);
    const std::vector<FlightSignals> flight = {test::makeThrustFlight(made, seed)};
    const ThrustFit fit = fitFlights(made, flight);
    const double voltage = fit.curve.voltage.mean, mean = meanCommand(flight);
    supported += fit.curve.supported() ? 1 : 0;
    for (std::size_t i = 0; i <= fit.curve.thrusts.size(); ++i) {
      const bool at_hover = i == fit.curve.thrusts.size();
      const double thrust = at_hover ? made.mass * 9.8066 : fit.curve.thrusts[i];
      const double truth = commandOf(made, thrust, voltage, mean);
      const FittedParameter& command =
          parameterOf(fit, at_hover ? "hover_command" : "command_" + std::to_string(i + 1));
      EXPECT_NEAR(polynomialAt(fit.curve.polynomial, thrust), command.value, 1e-9);
      EXPECT_NEAR(command.value, truth, 0.03) << seed << " at " << thrust;
      inside += holds(command, truth) ? 1 : 0;
      ++all;
    }
  }
  EXPECT_GE(inside, 9 * all / 10);
  EXPECT_GE(supported, kVehicles - 1);
}

// Without noise, wind or a battery that changes, the curve is that of the vehicle. Quadratic and cubic are told apart.
TEST(ThrustFit, FindsTheDegreeAndTheCurve) {
  MadeThrust made;
  made.gust = made.sag = made.drag = 0.0;
  made.noise = 0.05;
  made.empty = made.full;
  for (const std::vector<double>& hidden :
       {std::vector<double>{0.05, 0.03}, {0.12, 0.028, -0.0003}, {0.1, 0.045, -0.0018, 0.00004}}) {
    made.curve = hidden;
    const ThrustFit fit = fitFlights(made, {test::makeThrustFlight(made, 1)});
    EXPECT_EQ(fit.curve.polynomial.size(), hidden.size());
    EXPECT_TRUE(fit.curve.supported()) << fit.curve.reasons.front();
    EXPECT_TRUE(fit.warnings.empty());
    EXPECT_NEAR(fit.curve.lag + fit.curve.delay, made.lag + made.delay, 0.01);
    const double least = fit.curve.thrusts.front(), greatest = fit.curve.thrusts.back();
    for (double share = 0.0; share <= 1.0; share += 0.1) {
      const double thrust = least + share * (greatest - least);
      EXPECT_NEAR(polynomialAt(fit.curve.polynomial, thrust), commandOf(made, thrust), 0.004) << thrust;
    }
  }
}

// The regression of the command on the measured thrust is flatter, because the thrust is noisy.
TEST(ThrustFit, NoiseOfTheAccelerometerDoesNotMakeTheCurveFlatter) {
  MadeThrust made;
  made.curve = {0.05, 0.03};
  made.gust = made.sag = made.drag = 0.0;
  made.empty = made.full;
  made.noise = 3.0;
  const std::vector<FlightSignals> flight = {test::makeThrustFlight(made, 2)};
  const ThrustFit fit = fitFlights(made, flight, 1);
  EXPECT_NEAR(fit.curve.polynomial[1], 0.03, 0.001);
}

TEST(ThrustFit, TellsWhatTheVoltageDoes) {
  MadeThrust made;
  const ThrustFit fit = fitFlights(made, {test::makeThrustFlight(made, 3)});
  EXPECT_TRUE(fit.curve.supported());
  EXPECT_TRUE(holds(parameterOf(fit, "voltage_exponent"), 1.0));
  EXPECT_TRUE(fit.curve.voltage.matters);
  EXPECT_TRUE(mentions(fit.warnings, "fly within this range"));
  // A battery that the autopilot makes up for.
  made.exponent = 0.0;
  const ThrustFit steady = fitFlights(made, {test::makeThrustFlight(made, 3)});
  EXPECT_TRUE(steady.curve.supported());
  EXPECT_FALSE(steady.curve.voltage.matters);
  EXPECT_TRUE(steady.warnings.empty());
}

TEST(ThrustFit, WithoutAVoltageADriftIsNotSupported) {
  MadeThrust made;
  made.logs_voltage = false;
  const ThrustFit fit = fitFlights(made, {test::makeThrustFlight(made, 4)});
  EXPECT_FALSE(fit.curve.voltage.logged);
  EXPECT_FALSE(fit.curve.supported());
  EXPECT_TRUE(mentions(fit.curve.reasons, "log the battery"));
  made.exponent = 0.0;
  const ThrustFit steady = fitFlights(made, {test::makeThrustFlight(made, 4)});
  EXPECT_TRUE(steady.curve.supported());
}

TEST(ThrustFit, RefusesWithReasons) {
  const auto reasons = [](const MadeThrust& made, double mass) {
    ThrustOptions options;
    options.mass = mass;
    const ThrustFit fit = fitThrust({{test::makeThrustFlight(made, 5)}, {{}}}, options);
    EXPECT_EQ(fit.warnings.size(), fit.curve.reasons.size() + (fit.curve.voltage.matters ? 1 : 0));
    for (const FittedParameter& parameter : fit.parameters) EXPECT_FALSE(parameter.supported);
    return fit.curve.reasons;
  };
  MadeThrust made;
  made.excitation = 0.005;
  EXPECT_TRUE(mentions(reasons(made, made.mass), "Too little excitation"));
  made = {};
  made.scale = 1.06;
  EXPECT_TRUE(mentions(reasons(made, made.mass), "The accelerometer is off by 6"));
  made = {};
  made.noise = 12.0;
  EXPECT_TRUE(mentions(reasons(made, made.mass), "The fit is"));
  EXPECT_TRUE(mentions(reasons(made, made.mass), "On data that it was not fitted to"));
}

TEST(ThrustFit, AGivenDegreeMustBeTold) {
  MadeThrust made;
  made.curve = {0.05, 0.03};
  made.sag = 0.0;
  const std::vector<FlightSignals> flight = {test::makeThrustFlight(made, 6)};
  EXPECT_TRUE(mentions(fitFlights(made, flight, 3).curve.reasons, "take a lower --degree"));
  EXPECT_TRUE(fitFlights(made, flight, 1).curve.supported());
}

TEST(ThrustFit, ThrowsWhereThereIsNoCurve) {
  const MadeThrust made;
  const auto errorOf = [&made](const FlightSignals& flight) {
    try {
      fitFlights(made, {flight});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  FlightSignals newtons = test::makeThrustFlight(made, 7);
  for (double& command : newtons.series["thrust_cmd"].value) command *= 30.0;
  EXPECT_NE(errorOf(newtons).find("made thrust 7: thrust_cmd: must be a share of full thrust"),
            std::string::npos);
  FlightSignals turned = test::makeThrustFlight(made, 7);
  for (double& command : turned.series["thrust_cmd"].value) command = 1.0 - command;
  EXPECT_NE(errorOf(turned).find("does not rise with thrust_cmd"), std::string::npos);
  FlightSignals silent = test::makeThrustFlight(made, 7);
  silent.series.erase("thrust_cmd");
  EXPECT_NE(errorOf(silent).find("no signal thrust_cmd"), std::string::npos);
  FlightSignals still = test::makeThrustFlight(made, 7);
  still.not_flight = {{{0.0, 100.0}, "on the ground"}};
  EXPECT_NE(errorOf(still).find("no stretch of thrust"), std::string::npos);
}

// What is no flight changes nothing, however wild it is.
TEST(ThrustFit, OnlyFlightCounts) {
  const MadeThrust made;
  FlightSignals flight = test::makeThrustFlight(made, 8);
  flight.not_flight = {{{50.0, 60.0}, "upset"}};
  const ThrustFit before = fitFlights(made, {flight});
  TimeSeries& force = flight.series["specific_force_z"];
  for (std::size_t i = 0; i < force.time.size(); ++i) {
    if (force.time[i] > 50.5) force.value[i] = -30.0;
  }
  const ThrustFit after = fitFlights(made, {flight});
  EXPECT_TRUE(after.curve.supported());
  EXPECT_NEAR(parameterOf(after, "hover_command").value, parameterOf(before, "hover_command").value, 1e-6);
}

// From the vertical velocity where no accelerometer is logged.
TEST(ThrustFit, TakesTheVerticalMotionInPlaceOfAnAccelerometer) {
  const MadeThrust made;
  FlightSignals flight = test::makeThrustFlight(made, 9);
  flight.series.erase("specific_force_z");
  const ThrustFit fit = fitFlights(made, {flight});
  EXPECT_TRUE(fit.curve.supported());
  const double truth = commandOf(made, made.mass * 9.8066, fit.curve.voltage.mean, meanCommand({flight}));
  EXPECT_NEAR(parameterOf(fit, "hover_command").value, truth, 0.01);
}

// The command at hover changes from flight to flight (propellers, temperature).
TEST(ThrustFit, IntervalsOfSeveralFlightsHoldTheVehicle) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  int inside = 0;
  constexpr int kVehicles = 4;
  for (std::uint32_t vehicle = 0; vehicle < kVehicles; ++vehicle) {
    std::vector<FlightSignals> flights;
    MadeThrust made;
    made.sag = 0.0;
    made.duration = 30.0;
    for (std::uint32_t i = 0; i < 3; ++i) {
      MadeThrust one = made;
      const double factor = 1.0 + 0.03 * normal(random);
      for (double& coefficient : one.curve) coefficient *= factor;
      flights.push_back(test::makeThrustFlight(one, 10 * vehicle + i));
      for (auto& [name, series] : flights.back().series) {
        for (double& time : series.time) time += 1e4 * i;
      }
    }
    const ThrustFit fit = fitFlights(made, flights);
    ASSERT_EQ(fit.flights.size(), 3u);
    ASSERT_EQ(fit.flights.front().size(), fit.parameters.size());
    const FittedParameter& hover = parameterOf(fit, "hover_command");
    const double truth = commandOf(made, made.mass * 9.8066, fit.curve.voltage.mean, meanCommand(flights));
    inside += holds(hover, truth) ? 1 : 0;
    EXPECT_GT(hover.half_width, 0.003);
    EXPECT_NEAR(polynomialAt(fit.curve.polynomial, made.mass * 9.8066), hover.value, 1e-9);
    EXPECT_LT(fit.traces.front().time.back(), 1000.0);
  }
  EXPECT_EQ(inside, kVehicles);
}

}  // namespace
}  // namespace polyfly
