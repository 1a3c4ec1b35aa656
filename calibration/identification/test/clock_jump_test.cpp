// Flights whose clock was set in the middle of the record, or whose times are in another unit.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "identification/identify_axis.hpp"
#include "identification/motion.hpp"
#include "made_flight.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Time at which the clock is set, within 30 s of flight [s].
constexpr double kSet = 14.0;
// Step of a clock from zero to the time of day [s].
constexpr double kYears = 1.7e9;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Clock = std::function<double(double)>;

void setClock(const Clock& clock, TimeSeries* series) {
  for (double& time : series->time) time = clock(time);
}

// A flight on which the clocks of both signals are set.
AxisRecords flightWith(const Clock& clock) {
  AxisRecords records;
  records.axis = "roll";
  records.unit = records.command_unit = "rad";
  records.training = test::makeFlight({}, 1);
  setClock(clock, &records.training.command);
  setClock(clock, &records.training.response);
  return records;
}

Clock setBy(double seconds) {
  return [seconds](double time) { return time < kSet ? time : time + seconds; };
}

std::string refusalOf(const AxisRecords& records, const IdentifyOptions& options = {}) {
  try {
    identifyAxis(records, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

void expectTheLoop(const AxisModel& model, const std::string& trial) {
  const test::MadeLoop made;
  EXPECT_NEAR(model.with_delay.find("gain")->value, made.gain, 0.03) << trial;
  EXPECT_NEAR(model.with_delay.find("tau")->value, made.tau, 0.02) << trial;
  EXPECT_NEAR(model.with_delay.find("delay")->value, made.delay, 0.02) << trial;
}

TEST(ClockJump, LeavesBothPiecesOfTheFlight) {
  const AxisModel whole = identifyAxis(flightWith([](double time) { return time; }), {});
  for (const double jump : {90.0, 3600.0, kYears, 1e3 * kYears, -90.0, -3600.0, -kYears}) {
    const AxisModel model = identifyAxis(flightWith(setBy(jump)), {});
    expectTheLoop(model, std::to_string(jump));
    EXPECT_GT(static_cast<double>(model.with_delay.samples),
              0.8 * static_cast<double>(whole.with_delay.samples));
    for (const LoopSegment& segment : model.segments) EXPECT_LT(segment.duration(), 30.0);
    for (const TimeWindow& window : model.choice.windows) EXPECT_LT(window.to - window.from, 30.0);
  }
}

TEST(ClockJump, MayComeAtBothEndsAndSeveralTimes) {
  const std::vector<Clock> clocks = {
      [](double time) { return time < 0.1 ? time : time + kYears; },
      [](double time) { return time < 29.9 ? time : time + kYears; },
      [](double time) { return time < 29.9 ? time : time - kYears; },
      [](double time) { return time + 1000.0 * std::floor(time / 10.0); },
      [](double time) { return time - 1000.0 * std::floor(time / 10.0); },
      // for one sample or two
      [](double time) { return time > 9.98 && time < 10.02 ? time + kYears : time; },
  };
  for (std::size_t k = 0; k < clocks.size(); ++k) {
    expectTheLoop(identifyAxis(flightWith(clocks[k]), {}), std::to_string(k));
  }
}

TEST(ClockJump, OfOneSignalLeavesWhereBothAreKnown) {
  AxisRecords records = flightWith([](double time) { return time; });
  setClock(setBy(kYears), &records.training.response);
  const AxisModel of_response = identifyAxis(records, {});
  expectTheLoop(of_response, "response");
  for (const LoopSegment& segment : of_response.segments) EXPECT_LT(segment.time.back(), kSet);
  records = flightWith([](double time) { return time; });
  setClock(setBy(kYears), &records.training.command);
  expectTheLoop(identifyAxis(records, {}), "command");
}

TEST(ClockJump, ToAnotherUnitLeavesWhatIsInSeconds) {
  for (const double unit : {1e3, 1e6, 1e9}) {
    const AxisModel model =
        identifyAxis(flightWith([unit](double time) { return time < kSet ? time : unit * time; }), {});
    expectTheLoop(model, std::to_string(unit));
  }
}

TEST(ClockJump, TimesInAnotherUnitAreRefusedInWords) {
  IdentifyOptions given;
  given.windows = {{0.0, 1e12}};
  for (const double unit : {1e3, 1e6, 1e9}) {
    const AxisRecords records = flightWith([unit](double time) { return unit * time; });
    for (const IdentifyOptions& options : {IdentifyOptions{}, given}) {
      EXPECT_NE(refusalOf(records, options).find("are the times in seconds?"), std::string::npos) << unit;
    }
  }
}

TEST(ClockJump, OfEverySampleLeavesNothingAndSaysWhy) {
  int sample = 0;
  AxisRecords records = flightWith([](double time) { return time; });
  for (double& time : records.training.response.time) time += 100.0 * (++sample % 2 == 0 ? sample : -sample);
  EXPECT_NE(refusalOf(records).find("roll: no stretch"), std::string::npos);
}

TEST(ClockJump, WithTimesThatAreNoNumbersIsToldFromThem) {
  const std::vector<double> time = {0.0, kNan, 0.1, kInfinity, 1e300, 0.2, -kInfinity, -50.0};
  const std::vector<FarStep> steps = farSteps(time);
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_EQ(steps[0].from, 0.1);
  EXPECT_EQ(steps[0].to, 1e300);
  EXPECT_EQ(steps[1].to, 0.2);
  const TimeSeries clean = cleaned({time, std::vector<double>(time.size(), 1.0)});
  EXPECT_EQ(clean.time, (std::vector<double>{0.0, 0.1, 0.2, 1e300}));
}

TEST(ClockJump, IsToldWithItsPlaceAndSize) {
  EXPECT_TRUE(sentencesOn(farSteps({0.0, 50.0, 20.0})).empty());
  EXPECT_EQ(sentencesOn(farSteps({0.0, 12.5, 3612.5})),
            std::vector<std::string>{"after 12.5 s the times jump by 3600 s"});
  EXPECT_EQ(sentencesOn(farSteps({1700000012.5, 12.0})),
            std::vector<std::string>{"after 1700000012.5 s the times jump by -1.7e+09 s"});
  std::vector<double> many;
  for (int k = 0; k < 100; ++k) many.push_back(100.0 * k);
  const std::vector<std::string> told = sentencesOn(farSteps(many));
  ASSERT_EQ(told.size(), 6u);
  EXPECT_EQ(told.back(), "the times jump 94 times more");
}

TEST(ClockJump, CutsWindowsAndDurations) {
  const std::vector<double> time = {0.0, 10.0, 1000.0, 1010.0, 5000.0};
  const std::vector<TimeWindow> left = cutAtFarSteps({{0.0, 5000.0}, {5.0, 8.0}, {500.0, 1005.0}}, time);
  ASSERT_EQ(left.size(), 4u);
  EXPECT_EQ(left[0].to, 10.0);
  EXPECT_EQ(left[1].from, 1000.0);
  EXPECT_EQ(left[1].to, 1010.0);
  EXPECT_EQ(left[2].to, 8.0);
  EXPECT_EQ(left[3].from, 1000.0);
  EXPECT_EQ(durationOf(time), 20.0);
  EXPECT_EQ(durationOf({3612.0, 3613.0, 13.0, 15.0}), 3.0);
  EXPECT_EQ(cumulativeIntegral(time, {1.0, 1.0, 1.0, 1.0, 1.0}).back(), 20.0);
}

// Constant velocities at 50 Hz, level flight.
FlightSignals levelFlight() {
  FlightSignals signals;
  signals.source = "level flight";
  for (const char* name : {"vx", "vy", "vz", "roll", "pitch", "yaw"}) {
    TimeSeries& series = signals.series[name];
    for (int k = 0; k < 1500; ++k) {
      series.time.push_back(0.02 * k);
      series.value.push_back(name[0] == 'v' ? 0.1 * std::sin(0.01 * k) : 0.0);
    }
  }
  return signals;
}

TEST(ClockJump, OfTheAttitudeEndsWhatIsKnownOfTheMotion) {
  const std::size_t whole = motionOf(levelFlight(), {}).time.size();
  FlightSignals signals = levelFlight();
  setClock(setBy(kYears), &signals.series["pitch"]);
  const Motion motion = motionOf(signals, {});
  EXPECT_LT(motion.time.back(), kSet);
  EXPECT_GT(motion.time.size(), whole / 3);
  for (auto& [name, series] : signals.series) {
    if (name != "pitch") setClock(setBy(kYears), &series);
  }
  EXPECT_EQ(motionOf(signals, {}).time.size(), whole);
  EXPECT_EQ(motionOf(signals, {}).starts.size(), 3u);
}

TEST(ClockJump, IsToldOnceForTheSignalsThatShareIt) {
  FlightSignals signals = levelFlight();
  EXPECT_TRUE(clockRemarks(signals).empty());
  setClock(setBy(3600.0), &signals.series["vx"]);
  setClock(setBy(3600.0), &signals.series["vy"]);
  EXPECT_EQ(clockRemarks(signals),
            std::vector<std::string>{"vx, vy: after 13.98 s the times jump by 3600.02 s; cut there"});
}

}  // namespace
}  // namespace polyfly
