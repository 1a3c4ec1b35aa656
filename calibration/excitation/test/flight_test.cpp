#include "excitation/flight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "polyfly_base/error.hpp"
#include "polyfly_test/multirotor_plant.hpp"

namespace polyfly {
namespace {

constexpr double kPeriod = 0.01;

ExcitationPlan smallPlan() {
  return parsePlan(
      "rest: 3\n"
      "manoeuvres:\n"
      "  - {shape: 2-1-1, channels: [roll, pitch], amplitudes: [0.1, 0.2]}\n"
      "  - {shape: 2-1-1, channels: [yaw_rate, thrust], amplitudes: 0.5}\n",
      "plan");
}

// What a flight against the plant met.
struct Flown {
  // Greatest horizontal distance from the start [m].
  double farthest = 0.0;
  // Greatest height difference from the start [m].
  double highest = 0.0;
  std::vector<AttitudeCommand> commands;
  std::vector<int> running;
};

Flown fly(ExcitationFlight* flight, PlantOptions options, double seconds) {
  PlantState start;
  start.position = {1.0, 2.0, 5.0};
  start.yaw = 0.7;
  start.thrust = options.gravity;
  options.period = kPeriod;
  MultirotorPlant plant(options, start);
  Flown flown;
  for (int sample = 0; sample < static_cast<int>(seconds / kPeriod); ++sample) {
    const VehicleState state = plant.measure();
    flown.commands.push_back(flight->step(state));
    flown.running.push_back(flight->running());
    plant.advance(flown.commands.back());
    flown.farthest = std::max(flown.farthest, (plant.truth().position - start.position).head<2>().norm());
    flown.highest = std::max(flown.highest, std::abs(plant.truth().position.z() - start.position.z()));
  }
  return flown;
}

VehicleState resting(double stamp) {
  VehicleState state;
  state.stamp = stamp;
  return state;
}

TEST(ExcitationFlight, fliesThePlanInWindAndHoldsHeightAndPlace) {
  ExcitationFlight flight(smallPlan(), {});
  PlantOptions plant;
  plant.wind = {0.4, -0.3, 0.0};
  plant.position_noise = 0.005;
  plant.velocity_noise = 0.01;
  plant.attitude_noise = 0.002;
  const Flown flown = fly(&flight, plant, flight.plan().duration() + 2.0);
  EXPECT_EQ(flight.state(), ExcitationState::kDone);
  EXPECT_LT(flown.farthest, 4.0);
  EXPECT_LT(flown.highest, 0.3);
  // every manoeuvre was flown, and what was sent is the frozen hold plus the pulses
  for (int index = 0; index < static_cast<int>(flight.plan().manoeuvres.size()); ++index) {
    EXPECT_NE(std::find(flown.running.begin(), flown.running.end(), index), flown.running.end()) << index;
  }
  const auto first = std::find(flown.running.begin(), flown.running.end(), 0) - flown.running.begin();
  const auto at = [&](double time) {
    return flown.commands[static_cast<std::size_t>(first + std::lround(time / kPeriod))];
  };
  EXPECT_NEAR(at(0.1).roll - at(0.9).roll, 0.2, 1e-9);
  EXPECT_EQ(at(0.1).roll, at(1.3).roll);
  EXPECT_EQ(at(0.1).pitch, at(0.9).pitch);
}

TEST(ExcitationFlight, theSameOdometryGivesTheSameCommands) {
  ExcitationFlight one(smallPlan(), {});
  ExcitationFlight other(smallPlan(), {});
  const Flown first = fly(&one, {}, 20.0);
  const Flown second = fly(&other, {}, 20.0);
  for (std::size_t sample = 0; sample < first.commands.size(); ++sample) {
    EXPECT_EQ(first.commands[sample].roll, second.commands[sample].roll);
    EXPECT_EQ(first.commands[sample].thrust, second.commands[sample].thrust);
  }
}

TEST(ExcitationFlight, abortsAtItsLimitsAndHoldsThere) {
  ExcitationOptions narrow;
  narrow.attitude_max = 0.15;
  ExcitationFlight attitude(smallPlan(), narrow);
  const Flown flown = fly(&attitude, {}, 60.0);
  EXPECT_EQ(attitude.state(), ExcitationState::kAborted);
  EXPECT_STREQ(attitude.reason(), "attitude");
  EXPECT_LT(flown.farthest, 3.0);
  EXPECT_LT(std::abs(flown.commands.back().roll), 1e-2);  // it came to rest where that was

  narrow = {};
  narrow.distance_max = 0.2;
  ExcitationFlight distance(smallPlan(), narrow);
  fly(&distance, {}, 30.0);
  EXPECT_STREQ(distance.reason(), "distance");

  narrow = {};
  narrow.height_max = 0.1;
  ExcitationFlight height(smallPlan(), narrow);
  VehicleState state = resting(1.0);
  height.step(state);
  state.stamp = 1.01;
  state.position.z() = -0.2;
  height.step(state);
  EXPECT_STREQ(height.reason(), "height");
}

TEST(ExcitationFlight, badOdometryAbortsAndLevels) {
  ExcitationFlight flight(smallPlan(), {});
  flight.step(resting(1.0));
  VehicleState state = resting(1.01);
  state.velocity.x() = std::numeric_limits<double>::quiet_NaN();
  const AttitudeCommand command = flight.step(state);
  EXPECT_EQ(flight.state(), ExcitationState::kAborted);
  EXPECT_EQ(command.roll, 0.0);
  EXPECT_DOUBLE_EQ(command.thrust, 1.52 * 9.8066);
  ExcitationFlight back(smallPlan(), {});
  back.step(resting(1.0));
  back.step(resting(0.5));
  EXPECT_STREQ(back.reason(), "clock jumped back");
}

TEST(ExcitationFlight, silenceLevelsTheVehicle) {
  ExcitationFlight flight(smallPlan(), {});
  AttitudeCommand command;
  EXPECT_FALSE(flight.onSilence(5.0, &command));  // it has not begun
  flight.step(resting(10.0));
  EXPECT_FALSE(flight.onSilence(10.29, &command));
  EXPECT_TRUE(flight.onSilence(10.31, &command));
  EXPECT_EQ(flight.state(), ExcitationState::kAborted);
  EXPECT_EQ(command.pitch, 0.0);
  EXPECT_DOUBLE_EQ(command.thrust, 1.52 * 9.8066);
  flight.step(resting(11.0));
  EXPECT_EQ(flight.state(), ExcitationState::kAborted);  // not taken up again
}

TEST(ExcitationFlight, aMovedStickEndsAllCommands) {
  ExcitationFlight flight(smallPlan(), {});
  flight.step(resting(1.0));
  flight.onSticks({0.0F, 0.5F, 0.0F, 0.0F});
  flight.onSticks({0.1F, 0.5F, 0.0F, 0.0F});
  EXPECT_EQ(flight.state(), ExcitationState::kRunning);
  flight.onSticks({0.0F, 0.7F, 0.0F, 0.0F});
  EXPECT_EQ(flight.state(), ExcitationState::kHandedOver);
  EXPECT_FALSE(flight.commands());
  AttitudeCommand command;
  EXPECT_FALSE(flight.onSilence(99.0, &command));
}

TEST(ExcitationFlight, aWingRollsOnlyAndHoldsItsHeight) {
  ExcitationOptions wing;
  wing.wing = true;
  wing.distance_max = 1000.0;
  EXPECT_THROW(ExcitationFlight(smallPlan(), wing), Error);
  ExcitationFlight flight(
      parsePlan("rest: 1\nmanoeuvres: [{shape: 2-1-1, channels: roll, amplitudes: 0.3}]", "plan"), wing);
  VehicleState state = resting(1.0);
  state.velocity.x() = 15.0;
  flight.step(state);
  state.stamp = 2.1;
  state.position = {150.0, 0.0, -1.0};
  const AttitudeCommand command = flight.step(state);
  EXPECT_GT(command.pitch, wing.wing_pitch);
  EXPECT_EQ(command.thrust, wing.wing_thrust);
  EXPECT_EQ(flight.running(), 0);
}

TEST(ExcitationFlight, badOptionsAreRefused) {
  ExcitationOptions options;
  options.distance_max = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ExcitationFlight(smallPlan(), options), Error);
  options = {};
  options.thrust_max = 9.0;
  EXPECT_THROW(ExcitationFlight(smallPlan(), options), Error);
  options = {};
  options.wing = true;  // it would leave the room of a multirotor within a second
  EXPECT_THROW(
      ExcitationFlight(parsePlan("manoeuvres: [{shape: 2-1-1, channels: roll, amplitudes: 0.3}]", "plan"),
                       options),
      Error);
}

}  // namespace
}  // namespace polyfly
