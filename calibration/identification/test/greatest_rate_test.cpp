// The greatest rate of made loops: where it is flown, where it is not, and what else looks like it.
#include "identification/greatest_rate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "identification/attitude_output.hpp"
#include "identification/fit_loop.hpp"
#include "identification/identify_axis.hpp"
#include "identification/several_flights.hpp"
#include "made_flight.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

/// A fixed wing that rolls by at most 0.15 rad/s, and steps of up to 40 degrees that are held for 6 s.
test::MadeLoop slowRoller() {
  test::MadeLoop made;
  made.order = LoopOrder::kSecond;
  made.a0 = 4.0;
  made.a1 = 3.2;
  made.rate_greatest = 0.15;
  made.noise = 0.002;
  made.pulse = 6.0;
  made.size = 2.0;
  made.duration = 150.0;
  made.response_rate = made.command_rate = 20.0;
  return made;
}

/// One of 0.6 rad/s, whose moves are short.
test::MadeLoop fastRoller() {
  test::MadeLoop made = slowRoller();
  made.a0 = 14.0;
  made.a1 = 6.5;
  made.rate_greatest = 0.6;
  made.response_rate = 50.0;
  return made;
}

void expectLoopOf(const test::MadeLoop& made, const AxisModel& model) {
  const LoopFit& fit = model.findModel("model_second_order")->fit;
  EXPECT_NEAR(fit.find("a0")->value, made.a0, 0.15 * made.a0);
  EXPECT_NEAR(fit.find("a1")->value, made.a1, 0.15 * made.a1);
  EXPECT_NEAR(fit.find("delay")->value, made.delay, 0.05);
}

GreatestRate rateOf(const LoopRecord& record, double duration) {
  return greatestRate(loopRates({cutSegments(record, {{0.0, duration}}, FitOptions().delay_greatest)}));
}

AxisRecords rollRecords(LoopRecord training) {
  AxisRecords records;
  records.axis = "roll";
  records.unit = records.command_unit = "rad";
  records.training = std::move(training);
  return records;
}

AxisModel identified(const test::MadeLoop& made, std::uint32_t seed) {
  const AxisRecords records = rollRecords(test::makeFlight(made, seed));
  IdentifyOptions options;
  options.windows = {{0.0, made.duration}};
  options.second_order = true;
  return identifyAxis(records, options);
}

TEST(GreatestRate, IsFoundWithAnIntervalWhereLargeStepsAreHeld) {
  for (const double limit : {0.12, 0.15, 0.2}) {
    for (std::uint32_t seed = 1; seed <= 10; ++seed) {
      test::MadeLoop made = slowRoller();
      made.rate_greatest = limit;
      const GreatestRate rate = rateOf(test::makeFlight(made, seed), made.duration);
      ASSERT_TRUE(rate.supported()) << rate.reasons.front();
      EXPECT_NEAR(rate.value, limit, 0.05 * limit) << seed;
      EXPECT_LT(rate.half_width, 0.1 * limit);
    }
  }
}

TEST(GreatestRate, OfAFastLoopToo) {
  const test::MadeLoop made = fastRoller();
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    const GreatestRate rate = rateOf(test::makeFlight(made, seed), made.duration);
    ASSERT_TRUE(rate.supported()) << rate.reasons.front();
    EXPECT_NEAR(rate.value, 0.6, 0.03) << seed;
  }
}

TEST(GreatestRate, IsNotSupportedByALinearLoop) {
  for (const double noise : {0.0, 0.002, 0.01}) {
    for (std::uint32_t seed = 1; seed <= 10; ++seed) {
      test::MadeLoop made = slowRoller();
      made.rate_greatest = 0.0;
      made.noise = noise;
      EXPECT_FALSE(rateOf(test::makeFlight(made, seed), made.duration).supported()) << noise << ' ' << seed;
      made.order = LoopOrder::kFirst;
      EXPECT_FALSE(rateOf(test::makeFlight(made, seed), made.duration).supported()) << noise << ' ' << seed;
    }
  }
}

TEST(GreatestRate, IsNotSupportedBySmallStepsOfALoopThatHasOne) {
  test::MadeLoop made = slowRoller();
  made.size = 0.25;
  made.rate_greatest = 0.3;
  const GreatestRate rate = rateOf(test::makeFlight(made, 1), made.duration);
  EXPECT_FALSE(rate.supported());
  EXPECT_NE(rate.reasons.at(0).find("fly large steps"), std::string::npos);
}

// Their rates agree, and over a stretch that is longer than a move its mean rate is steady.
TEST(GreatestRate, IsNotSupportedByEqualStepsOfAFastLinearLoop) {
  for (const double frequency : {3.7, 6.0, 10.0, 20.0}) {
    for (const int delay : {0, 20, 40}) {
      LoopRecord record;
      double angle = -0.3, rate = 0.0;
      const auto commandAt = [](int i) { return i < 0 || (i / 300) % 2 == 0 ? -0.3 : 0.3; };
      for (int i = 0; i < 6000; ++i) {
        record.command.time.push_back(0.01 * i);
        record.command.value.push_back(commandAt(i));
        record.response.time.push_back(0.01 * i);
        record.response.value.push_back(angle);
        rate += 0.01 * (frequency * frequency * (commandAt(i - delay) - angle) - 1.7 * frequency * rate);
        angle += 0.01 * rate;
      }
      const GreatestRate found = rateOf(record, 60.0);
      EXPECT_FALSE(found.supported()) << frequency << ' ' << delay << ": " << found.value;
    }
  }
}

// A linear loop that follows a command which moves at one rate moves at that rate too.
TEST(GreatestRate, IsNotThatOfTheCommand) {
  LoopRecord record;
  double angle = 0.0, rate = 0.0;
  for (int i = 0; i < 12000; ++i) {
    const double time = 0.01 * i;
    const double wave = std::abs(std::fmod(time, 12.0) - 6.0) / 6.0;  // a triangle
    const double command = 1.2 * wave - 0.6;
    record.command.time.push_back(time);
    record.command.value.push_back(command);
    record.response.time.push_back(time);
    record.response.value.push_back(angle);
    rate += 0.01 * (14.0 * (command - angle) - 6.5 * rate);
    angle += 0.01 * rate;
  }
  const LoopRates rates = loopRates({cutSegments(record, {{0.0, 120.0}}, 0.6)}).front();
  EXPECT_TRUE(rates.moves.empty());
  EXPECT_NEAR(rates.fastest, 0.2, 0.05);
}

TEST(GreatestRate, AMoveThatIsFasterElsewhereSpeaksAgainstIt) {
  LoopRates flight;
  for (const double rate : {0.15, 0.151, 0.149}) flight.moves.push_back({{0.0, 1.0}, rate});
  flight.fastest = 0.16;
  EXPECT_TRUE(greatestRate({flight}).supported());
  LoopRates other;
  other.fastest = 0.3;
  EXPECT_FALSE(greatestRate({flight, other}).supported());
  LoopRates apart = flight;
  apart.moves.push_back({{0.0, 1.0}, 0.185});
  EXPECT_FALSE(greatestRate({apart}).supported());
  // Far below the fastest: not at the limit.
  flight.moves.push_back({{0.0, 1.0}, 0.05});
  EXPECT_NEAR(greatestRate({flight}).value, 0.15, 1e-12);
}

// What moves at the limit is left out of the linear fit, which then is that of the loop.
TEST(GreatestRate, LeavesTheLoopToTheRest) {
  const test::MadeLoop made = slowRoller();
  const AxisModel model = identified(made, 1);
  ASSERT_TRUE(model.greatest_rate && model.greatest_rate->supported());
  expectLoopOf(made, model);
  AttitudeCalibration calibration;
  calibration.axes.push_back(model);
  EXPECT_NE(toYaml(calibration).find("greatest_rate:"), std::string::npos);
  EXPECT_NE(toText(calibration).find("greatest rate 0.1"), std::string::npos) << toText(calibration);
}

// Rates that only the narrow stretch shows.
TEST(GreatestRate, LeavesAFastLoopToTheRestToo) {
  test::MadeLoop made = fastRoller();
  made.size = 1.0;
  const AxisModel model = identified(made, 1);
  ASSERT_TRUE(model.greatest_rate && model.greatest_rate->supported());
  EXPECT_LT(model.greatest_rate->half_stretch, 0.2);
  EXPECT_NEAR(model.greatest_rate->value, 0.6, 0.03);
  expectLoopOf(made, model);
}

// Moves of 0.4 s: over the wide stretch each would read as two thirds of its rate.
TEST(GreatestRate, IsLeftOutWhereShortMovesAreFlownAtIt) {
  LoopSegment segment;
  double angle = 0.0;
  for (int i = 0; i < 1200; ++i) {
    segment.time.push_back(0.01 * i);
    segment.response.push_back(angle);
    if (i % 300 >= 100 && i % 300 < 140) angle += 0.6 * 0.01;
  }
  GreatestRate rate;
  rate.value = 0.6;
  rate.half_stretch = 0.12;
  const std::vector<TimeWindow> found = stretchesAt(rate, {segment});
  ASSERT_EQ(found.size(), 4U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i].from, 3.0 * static_cast<double>(i) + 1.0, 0.05);
    EXPECT_NEAR(found[i].to, 3.0 * static_cast<double>(i) + 1.4, 0.05);
  }
}

TEST(GreatestRate, IsFoundInWindowsThatAreChosenToo) {
  test::MadeLoop made = slowRoller();
  made.pulse = 3.0;
  made.rate_greatest = 0.3;
  IdentifyOptions options;
  options.second_order = true;
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    const AxisModel model = identifyAxis(rollRecords(test::makeFlight(made, seed)), options);
    ASSERT_TRUE(model.greatest_rate && model.greatest_rate->supported()) << seed;
    EXPECT_NEAR(model.greatest_rate->value, 0.3, 0.015) << seed;
  }
}

bool leavesOutTheLimit(const std::vector<RejectedWindow>& windows) {
  return std::any_of(windows.begin(), windows.end(),
                     [](const RejectedWindow& one) { return one.reason == "the rate is at its limit"; });
}

// Two flights with two moves each: neither shows the rate alone.
TEST(GreatestRate, ThatOnlyTheFlightsTogetherShowIsLeftOutOfEach) {
  test::MadeLoop made = slowRoller();
  made.duration = 16.0;
  std::vector<AxisFlightRecords> flights;
  for (std::uint32_t seed = 1; seed <= 2; ++seed) {
    const LoopRecord record = test::makeFlight(made, seed);
    EXPECT_EQ(rateOf(record, made.duration).moves.size(), 2U);
    EXPECT_FALSE(rateOf(record, made.duration).supported());
    flights.push_back({rollRecords(record), {{0.0, made.duration}}});
  }
  IdentifyOptions options;
  options.second_order = true;
  const AxisModel model = identifyFlights(flights, options);
  ASSERT_TRUE(model.greatest_rate && model.greatest_rate->supported());
  EXPECT_EQ(model.greatest_rate->moves.size(), 4U);
  ASSERT_EQ(model.flights.size(), 2U);
  for (const AxisFlight& flight : model.flights) EXPECT_TRUE(leavesOutTheLimit(flight.left_out));
  const LoopFit& fit = model.findModel("model_second_order")->fit;
  EXPECT_NEAR(fit.find("a0")->value, made.a0, 0.15 * made.a0);
  EXPECT_NEAR(fit.find("a1")->value, made.a1, 0.15 * made.a1);
}

// A validation flight at the limit says nothing against a model of the rest.
TEST(GreatestRate, IsLeftOutOfTheValidationToo) {
  const test::MadeLoop made = slowRoller();
  AxisRecords records = rollRecords(test::makeFlight(made, 1));
  records.validation = test::makeFlight(made, 2);
  IdentifyOptions options;
  options.second_order = true;
  options.windows = options.validation_windows = {{0.0, made.duration}};
  const AxisModel model = identifyAxis(records, options);
  const ControllerModel* one = model.findModel("model_second_order");
  EXPECT_TRUE(one->supported());
  EXPECT_GT(one->validation->validation_percent, one->validation->training_percent - 2.0);
}

TEST(GreatestRate, IsNamedWhereNothingElseIsFlown) {
  const test::MadeLoop made = slowRoller();
  AxisRecords records = rollRecords(test::makeFlight(made, 1));
  IdentifyOptions options;
  options.second_order = true;
  options.windows.clear();
  for (const SteadyMove& move : rateOf(records.training, made.duration).moves)
    options.windows.push_back(move.window);
  try {
    identifyAxis(records, options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("roll: the response moves at its greatest rate"),
              std::string::npos)
        << error.what();
  }
}

TEST(GreatestRate, IsSaidNotToBeSupported) {
  test::MadeLoop made = slowRoller();
  made.rate_greatest = 0.0;
  AttitudeCalibration calibration;
  calibration.axes.push_back(identified(made, 1));
  EXPECT_NE(toText(calibration).find("not supported by this flight"), std::string::npos);
}

}  // namespace
}  // namespace polyfly
