#include "identification/several_flights.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "identification/random_effects.hpp"
#include "made_flight.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kReach = 0.6;  // [s]

// A vehicle whose parameters change slowly, in wind.
test::MadeLoop madeVehicle(std::mt19937& random) {
  const auto draw = [&random](double least, double greatest) {
    return std::uniform_real_distribution<double>(least, greatest)(random);
  };
  test::MadeLoop made;
  made.gain = draw(0.8, 1.2);
  made.tau = draw(0.1, 0.35);
  made.delay = draw(0.03, 0.15);
  made.noise = draw(0.002, 0.01);
  made.coloured_noise = draw(0.0, 0.02);
  made.drift = draw(0.0, 0.1);
  made.duration = 20.0;
  made.response_rate = 30.0;
  made.command_rate = 30.0;
  return made;
}

LoopFit fitFlight(const LoopRecord& record) {
  FitOptions options;
  options.global_evaluations = 100;
  options.local_evaluations = 60;
  return fitLoop(cutSegments(record, {{0.0, record.response.time.back()}}, kReach), options);
}

struct Coverage {
  int inside = 0;
  // Sum of half widths relative to the value.
  double width = 0.0;
};

// In how many of 100 vehicles the intervals hold the vehicle's mean parameters.
std::map<std::string, Coverage> coverageOf(int flights, double greatest_spread, bool first_alone) {
  std::map<std::string, Coverage> coverage;
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    std::mt19937 random(seed);
    const test::MadeLoop vehicle = madeVehicle(random);
    const double spread = std::uniform_real_distribution<double>(0.0, greatest_spread)(random);
    std::vector<LoopFit> fits;
    for (const LoopRecord& record : test::makeFlights(vehicle, spread, flights, random()))
      fits.push_back(fitFlight(record));
    const LoopFit pooled = first_alone ? fits.front() : poolFits(fits.front(), fits);
    for (const auto& [name, truth] : {std::pair{"gain", vehicle.gain}, std::pair{"tau", vehicle.tau},
                                      std::pair{"delay", vehicle.delay}}) {
      const FittedParameter& one = *pooled.find(name);
      coverage[name].inside += one.least() <= truth && truth <= one.greatest() ? 1 : 0;
      coverage[name].width += one.half_width / truth / 100.0;
    }
  }
  return coverage;
}

// Prints the table of calibration/README.md: run with --gtest_also_run_disabled_tests.
TEST(SeveralFlights, DISABLED_TableOfCoverage) {
  for (const double spread : {0.0, 0.05, 0.15, 0.3}) {
    for (const int flights : {1, 2, 3, 5, 8}) {
      for (const auto& [name, one] : coverageOf(flights, spread, flights == 1)) {
        std::printf("spread up to %.2f, %d flights, %s: %d inside, half width %.3f\n", spread, flights,
                    name.c_str(), one.inside, one.width);
      }
    }
  }
}

TEST(SeveralFlights, IntervalsHoldTheMeanOfVehiclesThatChange) {
  for (const auto& [name, one] : coverageOf(3, 0.15, false)) {
    EXPECT_GE(one.inside, 90) << name;
    EXPECT_LT(one.width, 0.3) << name;
  }
}

// What a single flight says of itself does not hold for the vehicle: the reason for all this.
TEST(SeveralFlights, TheIntervalOfOneFlightDoesNotHoldForTheVehicle) {
  EXPECT_LT(coverageOf(1, 0.15, true).at("gain").inside, 60);
}

std::vector<AxisFlightRecords> madeAxes(const std::vector<test::MadeLoop>& flown) {
  std::vector<AxisFlightRecords> flights;
  for (std::size_t i = 0; i < flown.size(); ++i) {
    AxisFlightRecords flight;
    flight.records.axis = "roll";
    flight.records.unit = flight.records.command_unit = "rad";
    flight.records.training = test::makeFlight(flown[i], static_cast<std::uint32_t>(i + 1));
    flight.records.training.source = "flight " + std::to_string(i + 1);
    // Clocks of their own, one of them since 1970.
    const double start = i == 1 ? 1.6e9 : -5.0 * static_cast<double>(i);
    for (double& time : flight.records.training.command.time) time += start;
    for (double& time : flight.records.training.response.time) time += start;
    flights.push_back(flight);
  }
  return flights;
}

std::string allWarnings(const AxisModel& model) {
  std::string text;
  for (const std::string& sentence : model.warnings) text += sentence + "\n";
  return text;
}

TEST(SeveralFlights, GivesOneModelOfThreeEqualFlights) {
  const test::MadeLoop made;
  IdentifyOptions options;
  options.second_order = true;
  const AxisModel model = identifyFlights(madeAxes({made, made, made}), options);
  EXPECT_TRUE(model.supported);
  EXPECT_TRUE(model.warnings.empty()) << allWarnings(model);
  EXPECT_NEAR(model.with_delay.gain, made.gain, 0.02);
  EXPECT_NEAR(model.with_delay.shape.tau, made.tau, 0.01);
  EXPECT_NEAR(model.with_delay.shape.delay, made.delay, 0.01);
  EXPECT_EQ(model.with_delay.gain, model.with_delay.find("gain")->value);
  EXPECT_NEAR(model.second_order->shape.omega, std::sqrt(model.second_order->find("a0")->value), 1e-9);
  ASSERT_EQ(model.flights.size(), 3u);
  ASSERT_TRUE(model.validation.has_value());
  EXPECT_TRUE(model.validation->by_flights);
  EXPECT_NEAR(model.validation->validation_percent, model.with_delay.fit_percent, 2.0);
  for (const AxisFlight& flight : model.flights)
    EXPECT_NEAR(flight.validation_percent, flight.fit_percent, 2.0);
  // The windows are those of each flight's own time, the segments those of one clock.
  EXPECT_GT(model.flights[1].windows.front().from, 1.6e9 - 1.0);
  EXPECT_LT(model.segments.back().time.back(), 400.0);
  for (std::size_t i = 1; i < model.segments.size(); ++i)
    EXPECT_GT(model.segments[i].time.front(), model.segments[i - 1].time.back());
  ASSERT_EQ(model.with_delay.prediction.size(), model.segments.size());
  ASSERT_EQ(model.validation->prediction.size(), model.validation->segments.size());
}

TEST(SeveralFlights, HandsOutModelsWithTheSpreadBetweenFlights) {
  test::MadeLoop weak;
  weak.gain = 0.95;
  test::MadeLoop strong;
  strong.gain = 1.05;
  IdentifyOptions options;
  options.second_order = true;
  const AxisModel model = identifyFlights(madeAxes({weak, {}, strong}), options);
  ASSERT_EQ(model.controller_models.size(), 4u);
  for (const ControllerModel& one : model.controller_models) {
    ASSERT_TRUE(one.validation.has_value());
    EXPECT_TRUE(one.validation->by_flights);
    EXPECT_EQ(one.validation->training_percent, one.fit.fit_percent);
    EXPECT_NEAR(one.validation->validation_percent, one.fit.fit_percent, 3.0) << one.key;
    // Of a loop of first order, the second-order numbers need not be bounded.
    if (one.fit.shape.order == LoopOrder::kFirst) {
      EXPECT_TRUE(one.supported()) << one.key;
    }
  }
  const ControllerModel& lag = *model.findModel("model_without_delay");
  EXPECT_NEAR(lag.fit.find("gain")->between_flights, 0.05, 0.015);
  EXPECT_EQ(lag.fit.gain, lag.fit.find("gain")->value);
  EXPECT_NEAR(lag.fit.shape.tau, test::MadeLoop().tau + test::MadeLoop().delay, 0.015);
  EXPECT_EQ(lag.fit.shape.delay, 0.0);
  EXPECT_EQ(model.with_delay.gain, model.controller_models.front().fit.gain);
  EXPECT_EQ(model.second_order->gain, model.findModel("model_second_order")->fit.gain);
}

TEST(SeveralFlights, LeaveOutOfEachWhatIsNoFlight) {
  std::vector<AxisFlightRecords> flights = madeAxes({{}, {}, {}});
  const LoopRecord& record = flights[1].records.training;
  const double start = std::min(record.command.time.front(), record.response.time.front());
  flights[1].records.training.not_flight = {{{start + 10.0, start + 13.0}, "upset"}};
  const AxisModel model = identifyFlights(flights, {});
  ASSERT_EQ(model.flights.size(), 3u);
  ASSERT_FALSE(model.flights[1].left_out.empty());
  EXPECT_EQ(model.flights[1].left_out.front().reason, "upset");
  EXPECT_NEAR(model.flights[1].left_out.front().window.from, start + 10.0, 1e-6);
  for (const TimeWindow& window : model.flights[1].windows)
    EXPECT_TRUE(window.to <= start + 10.01 || window.from >= start + 12.99);
  // On the clock of all flights, in the record too.
  ASSERT_EQ(model.record.not_flight.size(), 1u);
  EXPECT_NEAR(model.record.not_flight.front().window.from, model.flights[1].begins + 10.0, 1e-6);
}

TEST(SeveralFlights, IsTheFlightItselfWhereTheOthersSayNothing) {
  std::vector<AxisFlightRecords> flights = madeAxes({{}, {}});
  for (double& value : flights[1].records.training.command.value) value = 0.0;
  const AxisModel model = identifyFlights(flights, {});
  const AxisModel alone = identifyFlights({flights[0]}, {});
  EXPECT_TRUE(model.flights.empty());
  EXPECT_EQ(model.with_delay.gain, alone.with_delay.gain);
  EXPECT_EQ(model.with_delay.find("gain")->half_width, alone.with_delay.find("gain")->half_width);
  EXPECT_NE(allWarnings(model).find("Left out: flight 2: roll"), std::string::npos) << allWarnings(model);
  EXPECT_TRUE(alone.warnings.empty());
  for (double& value : flights[0].records.training.command.value) value = 0.0;
  EXPECT_THROW(identifyFlights(flights, {}), Error);
}

TEST(SeveralFlights, SaysWhereTheyDiffer) {
  test::MadeLoop heavy;
  heavy.gain = 0.6;
  const AxisModel model = identifyFlights(madeAxes({{}, {}, heavy}), {});
  EXPECT_NE(allWarnings(model).find("The flights differ in gain: "), std::string::npos) << allWarnings(model);
  EXPECT_NE(allWarnings(model).find("flight 3: the model of the other flights reaches"), std::string::npos);
  EXPECT_GT(model.with_delay.find("gain")->between_flights, 0.15);
  EXPECT_FALSE(model.supported);
  const ControllerModel& lag = *model.findModel("model_without_delay");
  ASSERT_FALSE(lag.reasons.empty());
  // The others' gain of 1 on a flight with 0.6: an error of two thirds.
  EXPECT_NEAR(model.flights[2].validation_percent, 35.0, 8.0);
}

TEST(SeveralFlights, AsksForAThirdFlightWhereTwoSayTooLittle) {
  test::MadeLoop other;
  other.tau = 0.3;
  const AxisModel model = identifyFlights(madeAxes({{}, other}), {});
  EXPECT_FALSE(model.with_delay.find("tau")->least() > 0.0);
  EXPECT_FALSE(model.supported);
  EXPECT_NE(allWarnings(model).find("Add a third flight"), std::string::npos) << allWarnings(model);
}

TEST(SeveralFlights, TakesTheGivenValidation) {
  std::vector<AxisFlightRecords> flights = madeAxes({{}, {}});
  for (AxisFlightRecords& flight : flights) flight.records.validation = test::makeFlight({}, 9);
  const AxisModel model = identifyFlights(flights, {});
  EXPECT_FALSE(model.validation->by_flights);
  for (const ControllerModel& one : model.controller_models) {
    EXPECT_FALSE(one.validation->by_flights);
    EXPECT_NEAR(one.validation->validation_percent,
                predictLoop(one.fit, one.validation->segments).fit_percent, 1e-9);
  }
  EXPECT_GT(model.validation->validation_percent, 85.0);
  EXPECT_GT(model.flights[0].validation_percent, 85.0);
}

}  // namespace
}  // namespace polyfly
