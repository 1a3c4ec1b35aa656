#include "identification/signal_units.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "made_stretches.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kDegreesPerUnit = 57.29577951308232;

// Roll and pitch of slow sines with their commands, and gravity.
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
    put("pitch", 0.15 * std::sin(1.7 * t));
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

// A tumble in which roll is counted beyond half a turn, again and again.
TEST(SignalUnits, AreJudgedWithinFlight) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    test::MadeStretches made;
    made.tumbles = 2.0;
    FlightSignals flight = test::makeStretches(made, seed).signals;
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

TEST(SignalUnits, RefuseACommandBeyondPi) {
  FlightSignals signals = madeSignals();
  scale(&signals, "roll_cmd", kDegreesPerUnit);
  EXPECT_THROW(checkUnits(&signals), Error);
}

TEST(SignalUnits, RefuseAnAngleBeyondPi) {
  FlightSignals signals = madeSignals();
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
