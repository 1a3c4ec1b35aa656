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

TEST(SignalUnits, SayNothingOfGoodSignals) {
  FlightSignals signals = madeSignals();
  EXPECT_TRUE(checkUnits(&signals).empty());
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    test::MadeStretches made;
    made.tumbles = 3.0;
    made.stands = 10.0;
    FlightSignals flight = test::makeStretches(made, seed).signals;
    EXPECT_TRUE(checkUnits(&flight).empty()) << seed;
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
    EXPECT_NO_THROW(checkUnits(&flight)) << seed;
    for (const char* name : {"roll", "roll_cmd"}) scale(&degrees, name, kDegreesPerUnit);
    EXPECT_THROW(checkUnits(&degrees), Error) << seed;
  }
}

TEST(SignalUnits, AdviseTheOtherUnitThanThatWhichWasChosen) {
  FlightSignals signals = madeSignals();
  signals.series.erase("gyro_x");
  scale(&signals, "roll", kDegreesPerUnit);
  signals.origin["roll"] = "ATT:Roll:deg";
  try {
    checkUnits(&signals);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("--signal roll=ATT:Roll takes it for radians"),
              std::string::npos)
        << error.what();
  }
}

// The unit of the gyro, or of an angle too small to be beyond pi.
TEST(SignalUnits, WarnWhereAngleAndRateDiffer) {
  FlightSignals signals = madeSignals();
  scale(&signals, "gyro_x", kDegreesPerUnit);
  scale(&signals, "pitch", 10.0);
  signals.origin["gyro_x"] = "gx_radps";
  const std::vector<std::string> told = checkUnits(&signals);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].find("roll changes by 0.017"), 0u) << told[0];
  EXPECT_NE(told[0].find("--signal gyro_x=gx_radps:deg takes it for degrees"), std::string::npos) << told[0];
  EXPECT_NE(told[1].find("--signal pitch=PLACE:deg"), std::string::npos) << told[1];
}

TEST(SignalUnits, RefuseACommandBeyondPi) {
  FlightSignals signals = madeSignals();
  scale(&signals, "roll_cmd", kDegreesPerUnit);
  EXPECT_THROW(checkUnits(&signals), Error);
}

TEST(SignalUnits, RefuseAnAngleBeyondPiThatNothingTells) {
  FlightSignals signals = madeSignals();
  signals.series.erase("gyro_x");
  scale(&signals, "roll", kDegreesPerUnit);
  signals.origin["roll"] = "roll_rad";
  try {
    checkUnits(&signals);
    FAIL() << "an angle of 11 rad was accepted";
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("made signals: roll: "), std::string::npos) << what;
    EXPECT_NE(what.find("--signal roll=roll_rad:deg"), std::string::npos) << what;
  }
}

TEST(SignalUnits, TellASign) {
  FlightSignals signals = madeSignals();
  scale(&signals, "gyro_y", -1.0);
  const std::vector<std::string> told = checkUnits(&signals);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_NE(told[0].find("opposite signs"), std::string::npos) << told[0];
}

TEST(SignalUnits, DropAnAccelerometerWithoutGravity) {
  for (const double unit : {-1.0, 1.0 / 9.80665, 0.0}) {
    FlightSignals signals = madeSignals();
    scale(&signals, "specific_force_z", unit);
    const std::vector<std::string> told = checkUnits(&signals);
    ASSERT_EQ(told.size(), 1u) << unit;
    EXPECT_EQ(told[0].find("=-PLACE turns its sign") != std::string::npos, unit < 0.0) << told[0];
    EXPECT_FALSE(signals.has("specific_force_z"));
  }
}

}  // namespace
}  // namespace polyfly
