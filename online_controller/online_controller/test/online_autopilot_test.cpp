// What is sent before a flight has begun, by what the autopilot says.
#include <gtest/gtest.h>

#include <string>

#include "online_controller/flight/autopilot.hpp"
#include "online_controller/flight/flight_supervisor.hpp"
#include "online_support.hpp"

namespace {

using polyfly::AutopilotHistory;
using polyfly::AutopilotReport;
using polyfly::ControlStatus;
using polyfly::FlightState;
using polyfly::IdleCommand;
using Place = AutopilotReport::Place;

constexpr AutopilotReport kSilent{};
constexpr AutopilotReport kDisarmed{true, false, false, Place::kOnGround};
constexpr AutopilotReport kDisarmedGuided{true, false, true, Place::kOnGround};
constexpr AutopilotReport kArmed{true, true, false, Place::kOnGround};
constexpr AutopilotReport kArmedGuided{true, true, true, Place::kOnGround};
constexpr AutopilotReport kFlies{true, true, false, Place::kInAir};
constexpr AutopilotReport kFliesGuided{true, true, true, Place::kInAir};
constexpr AutopilotReport kSomewhere{true, true, true, Place::kUnknown};

/// N nothing, Z zero thrust, F follow, H hold; after each of the reports.
template <std::size_t n>
std::string commands(const AutopilotReport (&reports)[n], bool streams) {
  AutopilotHistory history;
  std::string result;
  for (const AutopilotReport& report : reports) {
    history.add(report);
    result += "NZFH"[static_cast<int>(idleCommand(report, history, streams))];
  }
  return result;
}

// Rows: fresh, armed, guided, place; columns: nothing seen before, seen disarmed, seen disarmed and then in the air.
TEST(Autopilot, EachReportAfterEachHistory) {
  const struct {
    AutopilotReport report;
    const char* plain;
    const char* streams;
  } table[] = {
      {kSilent, "NNN", "NNN"},      {kDisarmed, "NNN", "ZZZ"},    {kDisarmedGuided, "NNN", "ZZZ"},
      {kArmed, "NNN", "NZN"},       {kArmedGuided, "NNN", "NZN"}, {kFlies, "NNN", "FFF"},
      {kFliesGuided, "HNN", "HHH"}, {kSomewhere, "NNN", "NNN"},
  };
  for (const auto& row : table) {
    for (const bool streams : {false, true}) {
      const AutopilotReport none[] = {row.report};
      const AutopilotReport grounded[] = {kDisarmed, row.report};
      const AutopilotReport flown[] = {kDisarmed, kFlies, row.report};
      const std::string found{commands(none, streams).back(), commands(grounded, streams).back(),
                              commands(flown, streams).back()};
      EXPECT_EQ(found, streams ? row.streams : row.plain)
          << row.report.fresh << row.report.armed << row.report.guided;
    }
  }
}

TEST(Autopilot, AFlightFromArmingToDisarming) {
  const AutopilotReport flight[] = {kArmed, kDisarmed,    kDisarmedGuided, kArmedGuided, kFliesGuided,
                                    kFlies, kFliesGuided, kArmedGuided,    kDisarmed,    kArmed};
  EXPECT_EQ(commands(flight, true), "NZZZHFHNZZ");
  EXPECT_EQ(commands(flight, false), "NNNNNNNNNN");
}

TEST(Autopilot, WhatWasNotSeenMayHaveBeenAFlight) {
  const AutopilotReport gap[] = {kDisarmed, kArmed, kSilent, kArmed, kDisarmed, kArmed};
  EXPECT_EQ(commands(gap, true), "ZZNNZZ");
}

TEST(Autopilot, AProgramThatBeganInFlightHoldsWhileGuided) {
  const AutopilotReport respawn[] = {kSilent, kFliesGuided, kFlies, kFliesGuided, kSilent, kFliesGuided};
  EXPECT_EQ(commands(respawn, false), "NHNHNH");
}

constexpr double kPeriod = 0.01;  // [s]

/// A vehicle that drifts at 1 m/s along x.
struct Drift {
  explicit Drift(bool streams = false)
      : law(vehicle()), supervisor(*law.controller, vehicle(), options(streams)) {
    state.position.z() = 5.0;
    state.velocity.x() = 1.0;
  }
  /// It does not follow its commands.
  static polyfly::MultirotorOptions vehicle() {
    polyfly::MultirotorOptions options;
    options.repeat_time = 0.0;
    return options;
  }
  static polyfly::FlightOptions options(bool streams) {
    polyfly::FlightOptions options;
    options.offboard_stream = streams;
    return options;
  }
  const polyfly::ControlReport& step(const AutopilotReport& report, int times = 1) {
    for (int k = 0; k < times; ++k) {
      state.stamp += kPeriod;
      state.position += kPeriod * state.velocity;
      supervisor.onAutopilot(report);
      supervisor.onOdometry(state);
    }
    return supervisor.report();
  }

  polyfly_test::Flight law;
  polyfly::FlightSupervisor supervisor;
  polyfly::VehicleState state;
};

TEST(IdleFlight, NothingIsSentBeforeAReference) {
  for (const AutopilotReport& report : {kSilent, kDisarmed, kArmed, kFlies, kSomewhere}) {
    Drift drift;
    EXPECT_EQ(drift.step(report, 3).status, ControlStatus::kNoReference);
    EXPECT_FALSE(drift.supervisor.sends());
    drift.supervisor.onSilence(drift.state.stamp + 1.0);
    EXPECT_EQ(drift.supervisor.report().status, ControlStatus::kNoReference);
    EXPECT_FALSE(drift.supervisor.sends());
  }
}

TEST(IdleFlight, TheStreamIsZeroThrustOnTheGround) {
  Drift drift(true);
  for (const AutopilotReport& report : {kDisarmed, kDisarmedGuided, kArmedGuided}) {
    EXPECT_EQ(drift.step(report).status, ControlStatus::kNoReference);
    EXPECT_TRUE(drift.supervisor.sends());
    EXPECT_EQ(drift.supervisor.report().command.thrust, 0.0);
    drift.supervisor.onSilence(drift.state.stamp);
    EXPECT_TRUE(drift.supervisor.sends());
    EXPECT_EQ(drift.supervisor.report().command.thrust, 0.0);
  }
  drift.step(kSilent);
  EXPECT_FALSE(drift.supervisor.sends());
}

TEST(IdleFlight, TheHeldPlaceFollowsUntilGuided) {
  Drift drift(true);
  drift.step(kFlies, 200);
  EXPECT_TRUE(drift.supervisor.sends());
  EXPECT_EQ(drift.supervisor.report().status, ControlStatus::kNoReference);
  EXPECT_EQ(drift.supervisor.state(), FlightState::kInactive);
  // Where it would come to rest, at 1 m/s by 2 m/s^2.
  EXPECT_NEAR(drift.supervisor.preview().front().position.x(), drift.state.position.x() + 0.25, 0.05);
  EXPECT_LT(drift.supervisor.report().command.pitch, 0.0);  // it would brake
  const double began = drift.state.position.x();
  drift.step(kFliesGuided, 50);
  EXPECT_EQ(drift.supervisor.state(), FlightState::kPositionHold);
  EXPECT_EQ(drift.supervisor.report().status, ControlStatus::kOptimal);
  EXPECT_NEAR(drift.supervisor.preview().front().position.x(), began + 0.25, 0.05);
  drift.step(kFlies);
  EXPECT_EQ(drift.supervisor.state(), FlightState::kInactive);
  EXPECT_NEAR(drift.supervisor.preview().front().position.x(), drift.state.position.x() + 0.25, 0.05);
}

TEST(IdleFlight, AfterARespawnItHoldsWhileGuidedAndAReferenceTakesOver) {
  Drift drift;
  drift.step(kFliesGuided, 20);
  EXPECT_EQ(drift.supervisor.state(), FlightState::kPositionHold);
  EXPECT_TRUE(drift.supervisor.sends());
  for (const AutopilotReport& end : {kFlies, kSilent, kSomewhere}) {
    drift.step(end);
    EXPECT_EQ(drift.supervisor.state(), FlightState::kInactive);
    EXPECT_FALSE(drift.supervisor.sends());
    drift.step(kFliesGuided);
    EXPECT_TRUE(drift.supervisor.sends());
  }
  // Once a reference has come, the flight is the reference's, whatever the autopilot says.
  EXPECT_EQ(drift.supervisor.onReference(polyfly::ReferenceTrajectory::pose(drift.state.position, 0.0),
                                         std::nullopt),
            nullptr);
  drift.step(kSilent, 3);
  EXPECT_EQ(drift.supervisor.state(), FlightState::kPositionHold);
  EXPECT_TRUE(drift.supervisor.sends());
}

TEST(IdleFlight, AHoldThatLosesItsOdometryFailsSafeUntilGuidedEnds) {
  Drift drift;
  drift.step(kFliesGuided, 20);
  drift.supervisor.onAutopilot(kFliesGuided);
  drift.supervisor.onSilence(drift.state.stamp + 0.2);
  EXPECT_EQ(drift.supervisor.state(), FlightState::kFailsafe);
  EXPECT_TRUE(drift.supervisor.sends());
  drift.supervisor.onAutopilot(kFlies);
  drift.supervisor.onSilence(drift.state.stamp + 0.21);
  EXPECT_EQ(drift.supervisor.state(), FlightState::kInactive);
  EXPECT_FALSE(drift.supervisor.sends());
}

}  // namespace
