#include "identification/signal_units.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "made_stretches.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kDegreesPerUnit = 57.29577951308232;

// Roll, pitch and yaw of slow sines with their gyros and commands, and gravity.
FlightSignals madeSignals() {
  FlightSignals signals;
  signals.source = "made signals";
  for (int i = 0; i < 6000; ++i) {
    const double t = 0.01 * i;
    const auto put = [&](const char* name, double value) {
      signals.series[name].time.push_back(t);
      signals.series[name].value.push_back(value);
    };
    put("roll", 0.2 * std::sin(1.3 * t));
    put("roll_cmd", 0.2 * std::sin(1.3 * (t + 0.1)));
    put("gyro_x", 0.26 * std::cos(1.3 * t));
    put("pitch", 0.15 * std::sin(1.7 * t));
    put("gyro_y", 0.255 * std::cos(1.7 * t));
    put("yaw", std::remainder(5.0 * std::sin(0.4 * t), 6.283185307179586));
    put("gyro_z", 2.0 * std::cos(0.4 * t));
    put("yaw_rate", 2.0 * std::cos(0.4 * t));
    put("yaw_rate_cmd", 2.0 * std::cos(0.4 * (t + 0.1)));
    put("specific_force_z", 9.8 + 0.5 * std::sin(t));
  }
  return signals;
}

void scale(FlightSignals* signals, const std::string& name, double factor) {
  for (double& value : signals->series.at(name).value) value *= factor;
}

void expectAsMade(const FlightSignals& signals, double margin = 1e-6) {
  for (const auto& [name, series] : madeSignals().series) {
    ASSERT_TRUE(signals.has(name)) << name;
    for (std::size_t i = 0; i < series.value.size(); i += 97)
      EXPECT_NEAR(signals.at(name).value[i], series.value[i], margin) << name;
  }
}

TEST(SignalUnits, SayNothingOfGoodSignals) {
  FlightSignals signals = madeSignals();
  EXPECT_TRUE(settleUnits(&signals).empty());
  expectAsMade(signals);
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    test::MadeStretches made;
    made.tumbles = 3.0;
    made.stands = 10.0;
    FlightSignals flight = test::makeStretches(made, seed).signals;
    EXPECT_TRUE(settleUnits(&flight).empty()) << seed;
  }
}

// A tumble in which roll is counted beyond half a turn, again and again, and no gyro is there to tell the unit.
TEST(SignalUnits, AreJudgedWithinFlight) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    test::MadeStretches made;
    made.tumbles = 2.0;
    FlightSignals flight = test::makeStretches(made, seed).signals;
    for (const char* gyro : {"gyro_x", "gyro_y", "gyro_z"}) flight.series.erase(gyro);
    TimeSeries& roll = flight.series.at("roll");
    const double crash = roll.time.back() - made.tumbles;
    for (std::size_t i = 0; i < roll.time.size(); ++i) {
      if (roll.time[i] > crash) roll.value[i] = 1.0 + 2.6 * std::sin(12.0 * (roll.time[i] - crash));
    }
    FlightSignals degrees = flight;
    EXPECT_NO_THROW(settleUnits(&flight)) << seed;
    for (const char* name : {"roll", "roll_cmd"}) scale(&degrees, name, kDegreesPerUnit);
    EXPECT_THROW(settleUnits(&degrees), Error) << seed;
  }
}

TEST(SignalUnits, AdviseTheOtherUnitThanThatWhichWasChosen) {
  FlightSignals signals = madeSignals();
  signals.series.erase("gyro_x");
  scale(&signals, "roll", kDegreesPerUnit);
  signals.origin["roll"] = "ATT:Roll:deg";
  try {
    settleUnits(&signals);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("--signal roll=ATT:Roll takes it for radians"),
              std::string::npos)
        << error.what();
  }
}

TEST(SignalUnits, TakeCentidegreesForWhatTheyAre) {
  FlightSignals signals = madeSignals();
  scale(&signals, "yaw_rate", 100.0);
  scale(&signals, "yaw_rate_cmd", 100.0);
  const std::vector<std::string> told = settleUnits(&signals);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_NE(told[0].find("yaw_rate is 100 times what gyro_z says"), std::string::npos) << told[0];
  expectAsMade(signals);
}

TEST(SignalUnits, CheckTheYawRateByTheYawAngleWithoutAGyro) {
  for (const double factor : {100.0, kDegreesPerUnit, 100.0 * kDegreesPerUnit}) {
    FlightSignals signals = madeSignals();
    signals.series.erase("gyro_z");
    scale(&signals, "yaw_rate", factor);
    scale(&signals, "yaw_rate_cmd", factor);
    EXPECT_EQ(settleUnits(&signals).size(), 2u) << factor;
    signals.series["gyro_z"] = madeSignals().at("gyro_z");
    expectAsMade(signals);
  }
}

TEST(SignalUnits, TakeDegreesUnderRadiansForWhatTheyAre) {
  FlightSignals signals = madeSignals();
  scale(&signals, "roll", kDegreesPerUnit);
  scale(&signals, "roll_cmd", kDegreesPerUnit);
  EXPECT_EQ(settleUnits(&signals).size(), 2u);
  expectAsMade(signals);
}

TEST(SignalUnits, ConvertACommandThatIsBeyondPi) {
  FlightSignals signals = madeSignals();
  signals.series.erase("gyro_x");
  scale(&signals, "roll_cmd", kDegreesPerUnit);
  EXPECT_EQ(settleUnits(&signals).size(), 1u);
  signals.series["gyro_x"] = madeSignals().at("gyro_x");
  expectAsMade(signals);
}

TEST(SignalUnits, RefuseAnAngleBeyondPiThatNothingTells) {
  FlightSignals signals = madeSignals();
  signals.series.erase("gyro_x");
  scale(&signals, "roll", kDegreesPerUnit);
  signals.origin["roll"] = "roll_rad";
  try {
    settleUnits(&signals);
    FAIL() << "an angle of 11 rad was accepted";
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("made signals: roll: "), std::string::npos) << what;
    EXPECT_NE(what.find("--signal roll=roll_rad:deg"), std::string::npos) << what;
  }
}

TEST(SignalUnits, RefuseWhereBothMayBeWrong) {
  FlightSignals signals = madeSignals();
  scale(&signals, "gyro_x", 1e-3);
  scale(&signals, "roll", 1e-3 * kDegreesPerUnit);
  EXPECT_THROW(settleUnits(&signals), Error);
}

TEST(SignalUnits, TellASignAndAnotherGyro) {
  FlightSignals signals = madeSignals();
  scale(&signals, "gyro_y", -kDegreesPerUnit);
  const std::vector<std::string> told = settleUnits(&signals);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_NE(told[0].find("opposite signs"), std::string::npos) << told[0];
  EXPECT_NE(told[1].find("gyro_y is 57.3 times what pitch says"), std::string::npos) << told[1];
}

TEST(SignalUnits, SetTheAccelerometerByGravity) {
  for (const double unit : {-1.0, 1.0 / 9.80665, 1000.0 / 9.80665}) {
    FlightSignals signals = madeSignals();
    scale(&signals, "specific_force_z", unit);
    EXPECT_EQ(settleUnits(&signals).size(), 1u) << unit;
    expectAsMade(signals, 1e-3);
  }
  FlightSignals signals = madeSignals();
  for (double& value : signals.series.at("specific_force_z").value) value -= 9.8;
  EXPECT_EQ(settleUnits(&signals).size(), 1u);
  EXPECT_FALSE(signals.has("specific_force_z"));
}

}  // namespace
}  // namespace polyfly
