// Warnings of a validation: records that were falsified on purpose, and a vehicle that is not the map's.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

#include "online_controller/estimation/odometry_gate.hpp"
#include "synthetic_flight.hpp"
#include "validation/validation.hpp"

namespace polyfly {
namespace {

class Warnings : public testing::Test {
 protected:
  ValidationReport validated(const FlightLog& log) {
    return validate(log, replay(log, maps_.axes(), options_), maps_.axes(), options_);
  }
  static bool has(const ValidationReport& report, const std::string& words) {
    for (const std::string& sentence : report.warnings) {
      if (sentence.find(words) != std::string::npos) return true;
    }
    return false;
  }
  // A flight of 60 s, each odometry with its command.
  static FlightLog minute() {
    FlightLog log;
    log.source = "minute.bag";
    for (int k = 0; k < 6000; ++k) {
      VehicleState state;
      state.stamp = 0.01 * k;
      log.add(state);
      log.commands.push_back({state.stamp, {}});
    }
    return log;
  }

  ScratchFolder folder_;
  HandMadeMaps maps_{folder_};
  MultirotorOptions options_;
};

TEST_F(Warnings, NoneForAFlightThatFits) {
  EXPECT_TRUE(validated(syntheticFlight(maps_.axes())).warnings.empty());
}

// A circle with the nose along it: in the body the velocity is forward all the time, in the world it turns.
TEST_F(Warnings, TellATwistInTheWorldsFrame) {
  for (const bool of_world : {false, true}) {
    FlightLog log = syntheticFlight(maps_.axes());
    for (VehicleState& state : log.odometry) {
      const double turned = state.stamp;
      const Eigen::Vector3d velocity(-3.0 * std::sin(turned), 3.0 * std::cos(turned), 0.0);
      state.position = {3.0 * std::cos(turned), 3.0 * std::sin(turned), 2.0};
      state.attitude = Eigen::AngleAxisd(turned + 1.5707963, Eigen::Vector3d::UnitZ());
      state.velocity = of_world ? state.attitude * velocity : velocity;
    }
    EXPECT_EQ(has(validated(log), kContradictionSentence), of_world);
  }
}

TEST_F(Warnings, TellCommandsOfSomethingElse) {
  FlightLog log = syntheticFlight(maps_.axes());
  for (std::size_t k = 0; k < log.commands.size(); ++k)
    log.commands[k].command.pitch = 0.3 * std::sin(0.37 * static_cast<double>(k));
  const ValidationReport report = validated(log);
  EXPECT_TRUE(has(report, "The recorded pitch commands are not those that these maps give"));
  EXPECT_FALSE(has(report, "The recorded roll commands"));
}

// Of a flight of 60 s: stamps and receive times, where odometry and commands have the same stamps.
void setClocks(FlightLog* log) {
  std::vector<double> odometry, commands;
  for (const VehicleState& state : log->odometry) odometry.push_back(state.stamp);
  for (const FlightLog::Command& command : log->commands) commands.push_back(command.stamp);
  std::vector<double> received(odometry.size());
  for (std::size_t k = 0; k < received.size(); ++k) received[k] = 100.0 + 0.01 * static_cast<double>(k);
  log->clocks = {{"/odometry", headerClock(odometry, received), received.front()},
                 {"/command", headerClock(commands, received), received.front()}};
}

TEST_F(Warnings, TellWhichClockJumped) {
  FlightLog log = minute();
  for (VehicleState& state : log.odometry) state.stamp += 100.0;
  for (FlightLog::Command& command : log.commands) command.stamp += 100.0;
  setClocks(&log);
  FlightLog odometry = log;
  for (VehicleState& state : odometry.odometry) state.stamp += state.stamp > 130.0 ? 120.0 : 0.0;
  setClocks(&odometry);
  EXPECT_TRUE(has(validated(odometry), "Topic /odometry: the clock of the headers jumps by 120 s"));
  EXPECT_FALSE(has(validated(odometry), "Topic /command"));
  EXPECT_TRUE(has(validated(odometry), "recorded commands answer no recorded odometry"));
  FlightLog commands = log;
  for (FlightLog::Command& command : commands.commands) command.stamp += command.stamp > 130.0 ? 0.6 : 0.0;
  setClocks(&commands);
  EXPECT_TRUE(has(validated(commands), "Topic /command: the clock of the headers jumps by 0.6 s"));
  FlightLog unstamped = log;
  for (FlightLog::Command& command : unstamped.commands) command.stamp = 0.0;
  setClocks(&unstamped);
  EXPECT_TRUE(has(validated(unstamped), "Topic /command: 6000 of 6000 messages have no stamp"));
}

// Odometry was silent: nothing is lost where the node noticed it.
TEST_F(Warnings, TellAPauseThatTheNodeDidNotNotice) {
  for (const bool noticed : {false, true}) {
    FlightRecorder recorder(maps_.axes(), options_);
    recorder.hold(SyntheticFlight::home());
    for (std::size_t sample = 0; sample < 100; ++sample) recorder.fly(SyntheticFlight::state(sample));
    if (noticed) recorder.beSilent(SyntheticFlight::state(140).stamp);
    for (std::size_t sample = 170; sample < 300; ++sample) recorder.fly(SyntheticFlight::state(sample));
    const ValidationReport report = validated(recorder.log());
    EXPECT_EQ(has(report, "Nothing is recorded from 0.99 to 1.7 s"), !noticed);
    EXPECT_EQ(report.warnings.empty(), noticed);
  }
}

TEST_F(Warnings, TellCommandsThatAreLost) {
  const FlightLog whole = syntheticFlight(maps_.axes());
  // The controller stops, and it pauses; a record that begins before the controller is whole.
  FlightLog stopped = whole, paused = whole, early = whole;
  const std::size_t size = whole.commands.size();
  stopped.commands.resize(size / 2);
  const auto at = [size](FlightLog* log, std::size_t share) {
    return log->commands.begin() + static_cast<std::ptrdiff_t>(share * size / 100);
  };
  paused.commands.erase(at(&paused, 30), at(&paused, 60));
  early.commands.erase(early.commands.begin(), at(&early, 50));
  EXPECT_TRUE(has(validated(stopped), "or its commands are lost"));
  EXPECT_TRUE(has(validated(paused), "or its commands are lost"));
  EXPECT_FALSE(has(validated(early), "or its commands are lost"));
}

TEST_F(Warnings, TellNorthEastDown) {
  FlightLog log = syntheticFlight(maps_.axes());
  for (VehicleState& state : log.odometry)
    state.position = Eigen::Vector3d(state.position.y(), state.position.x(), -state.position.z());
  const ValidationReport report = validated(log);
  EXPECT_TRUE(has(report, "north-east-down"));
  EXPECT_FALSE(brokenThresholds(report, {}).empty());
}

// The clock of all stamps is set after three of the ten seconds.
TEST_F(Warnings, TellAClockThatWasSet) {
  const ValidationReport whole = validated(syntheticFlight(maps_.axes()));
  for (const double jump : {1.7e9, 3600.0, -50000.0}) {
    FlightLog log = syntheticFlight(maps_.axes());
    const auto set = [jump](double* stamp) { *stamp += *stamp < SyntheticFlight::kStart + 3.0 ? 0.0 : jump; };
    for (VehicleState& state : log.odometry) set(&state.stamp);
    for (FlightLog::Command& command : log.commands) set(&command.stamp);
    for (FlightLog::Status& status : log.statuses) set(&status.stamp);
    const ValidationReport report = validated(log);
    EXPECT_TRUE(has(report, "Odometry: after 102.99 s the times jump by ")) << jump;
    EXPECT_NEAR(report.duration, whole.duration, 0.02) << jump;
    EXPECT_EQ(report.samples, whole.samples);
  }
}

}  // namespace
}  // namespace polyfly
