#include "identification/several_flights.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "made_flight.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// The rule, on numbers: the mean; the widest of the intervals, or half the spread.
TEST(MeanParameters, TakeTheWidestIntervalOrHalfTheSpread) {
  const double nothing = std::nan("");
  const auto flight = [](double gain, double half_gain, double tau, double half_tau) {
    return std::vector<FittedParameter>{{"gain", "1", gain, half_gain}, {"tau", "s", tau, half_tau}};
  };
  const auto means = meanParameters(
      {flight(1.0, 0.02, 0.20, 0.03), flight(1.1, 0.01, 0.21, nothing), flight(1.2, 0.03, 0.22, 0.05)});
  EXPECT_NEAR(means[0].value, 1.1, 1e-12);
  EXPECT_NEAR(means[0].half_width, 0.1, 1e-12);
  EXPECT_NEAR(means[1].value, 0.21, 1e-12);
  EXPECT_EQ(means[1].half_width, 0.05);
  EXPECT_TRUE(std::isnan(meanParameters({flight(1.0, 0.1, 0.2, nothing)})[1].half_width));
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
  const LoopFit& second = model.findModel("model_second_order")->fit;
  EXPECT_NEAR(second.shape.omega, std::sqrt(second.find("a0")->value), 1e-9);
  ASSERT_EQ(model.flights.size(), 3u);
  ASSERT_TRUE(model.validation.has_value());
  EXPECT_TRUE(model.validation->by_flights);
  EXPECT_NEAR(model.validation->validation_percent, model.with_delay.fit_percent, 2.0);
  EXPECT_NEAR(model.flights[1].choice.windows.front().from, 1.6e9, 40.0);
  EXPECT_NEAR(model.usedTime(),
              model.flights[0].usedTime() + model.flights[1].usedTime() + model.flights[2].usedTime(), 1e-6);
}

TEST(SeveralFlights, HandsOutTheMeanWithHalfTheSpread) {
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
  EXPECT_NEAR(lag.fit.find("gain")->half_width, 0.05, 0.015);
  EXPECT_EQ(lag.fit.gain, lag.fit.find("gain")->value);
  EXPECT_NEAR(lag.fit.shape.tau, test::MadeLoop().tau + test::MadeLoop().delay, 0.015);
  EXPECT_EQ(lag.fit.shape.delay, 0.0);
  EXPECT_EQ(model.with_delay.gain, model.controller_models.front().fit.gain);
}

TEST(SeveralFlights, LeaveOutOfEachWhatIsNoFlight) {
  std::vector<AxisFlightRecords> flights = madeAxes({{}, {}, {}});
  const LoopRecord& record = flights[1].records.training;
  const double start = std::min(record.command.time.front(), record.response.time.front());
  flights[1].records.training.not_flight = {{{start + 10.0, start + 13.0}, "upset"}};
  const AxisModel model = identifyFlights(flights, {});
  ASSERT_EQ(model.flights.size(), 3u);
  ASSERT_FALSE(model.flights[1].choice.rejected.empty());
  EXPECT_EQ(model.flights[1].choice.rejected.front().reason, "upset");
  EXPECT_NEAR(model.flights[1].choice.rejected.front().window.from, start + 10.0, 1e-6);
  for (const TimeWindow& window : model.flights[1].choice.windows)
    EXPECT_TRUE(window.to <= start + 10.01 || window.from >= start + 12.99);
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
  EXPECT_NEAR(model.with_delay.find("gain")->half_width, 0.2, 0.03);
  EXPECT_FALSE(model.supported);
  const ControllerModel& lag = *model.findModel("model_without_delay");
  ASSERT_FALSE(lag.reasons.empty());
  // The others' gain of 1 on a flight with 0.6: an error of two thirds.
  EXPECT_NEAR(model.validation->validation_percent, 35.0, 8.0);
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
  EXPECT_GT(model.flights[0].validation->validation_percent, 85.0);
}

}  // namespace
}  // namespace polyfly
