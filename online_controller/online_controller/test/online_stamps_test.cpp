// Any stamp may come: a stamp that jumps is out of order, and no first stamp keeps the true ones out.
#include <gtest/gtest.h>

#include <cmath>

#include "online_controller/flight/flight_supervisor.hpp"
#include "online_support.hpp"

namespace {

using polyfly::ControlReason;
using polyfly::ControlReport;
using polyfly::ControlStatus;
using polyfly::FlightState;
using polyfly::ReferenceTrajectory;

constexpr double kPeriod = 0.01;                                                // [s]
constexpr double kStart = 1000.0;                                               // [s]
constexpr double kGreatest = 4294967295.0;                                      // [s]
constexpr double kHostile[] = {0.0, kStart + 3600.0, 2147483648.0, kGreatest};  // [s]

/// A vehicle that stays where it is put.
struct Stand {
  explicit Stand(double start = kStart) : law(options()), supervisor(*law.controller, options(), {}) {
    state.stamp = start;
  }

  /// What stands repeats itself.
  static polyfly::MultirotorOptions options() {
    polyfly::MultirotorOptions options;
    options.repeat_time = 0.0;
    return options;
  }

  const ControlReport& step() {
    state.stamp += kPeriod;
    return supervisor.onOdometry(state);
  }
  const ControlReport& stepAt(double stamp) {
    polyfly::VehicleState wrong = state;
    wrong.stamp = stamp;
    return supervisor.onOdometry(wrong);
  }
  void hold() {
    step();
    supervisor.onReference(ReferenceTrajectory::pose({0.1, 0.0, 0.0}, 0.0), std::nullopt);
    for (int k = 0; k < 10; ++k) step();
  }

  polyfly_test::Flight law;
  polyfly::FlightSupervisor supervisor;
  polyfly::VehicleState state;
};

/// A line of one second without a start of its own.
ReferenceTrajectory line() {
  std::vector<polyfly::TrajectorySample> samples(2);
  samples[1].position = {0.1, 0.0, 0.0};
  samples[1].time = 1.0;
  for (auto& sample : samples) sample.has_velocity = sample.has_acceleration = true;
  return ReferenceTrajectory(std::move(samples));
}

TEST(Stamps, OneThatJumpsIsOutOfOrderAndTheNextTrueOneIsAnswered) {
  for (const double stamp : kHostile) {
    Stand stand;
    stand.hold();
    ASSERT_EQ(stand.supervisor.report().status, ControlStatus::kOptimal);
    const polyfly::AttitudeCommand before = stand.supervisor.report().command;
    EXPECT_EQ(stand.stepAt(stamp).reason, ControlReason::kOutOfOrder) << stamp;
    EXPECT_EQ(stand.supervisor.report().command.roll, before.roll) << stamp;
    EXPECT_EQ(stand.step().status, ControlStatus::kOptimal) << stamp;
    EXPECT_EQ(stand.step().reason, ControlReason::kNone) << stamp;
  }
}

TEST(Stamps, AFirstOneThatIsWrongKeepsNoTrueOnesOut) {
  for (const double stamp : kHostile) {
    Stand stand;
    stand.supervisor.onReference(line(), std::nullopt);
    stand.stepAt(stamp);
    // Until hold_periods samples agree that time is another one.
    for (int k = 0; k <= polyfly::MultirotorOptions{}.hold_periods; ++k) stand.step();
    EXPECT_EQ(stand.supervisor.report().status, ControlStatus::kOptimal) << stamp;
    for (int k = 0; k < 50; ++k) stand.step();
    EXPECT_EQ(stand.supervisor.state(), FlightState::kTrajectory) << stamp;
    EXPECT_NEAR(stand.supervisor.preview().front().position.x(), 0.05, 0.01) << stamp;
    for (int k = 0; k < 60; ++k) stand.step();
    EXPECT_EQ(stand.supervisor.state(), FlightState::kPositionHold) << stamp;
  }
}

TEST(Stamps, ATakeOffGoesOnWhereTimeBeginsAnew) {
  for (const double stamp : kHostile) {
    Stand stand;
    stand.step();
    ASSERT_EQ(stand.supervisor.takeOff(), nullptr);
    for (int k = 0; k < 200; ++k) stand.step();
    stand.state.stamp = stamp;
    for (int k = 0; k < 100; ++k) stand.step();
    const double height = stand.supervisor.preview().front().position.z();
    EXPECT_EQ(stand.supervisor.state(), FlightState::kTakeOff) << stamp;
    EXPECT_GT(height, 0.4) << stamp;
    EXPECT_LT(height, 0.8) << stamp;
    for (int k = 0; k < 300; ++k) stand.step();
    EXPECT_NEAR(stand.supervisor.preview().front().position.z(), 1.0, 1e-6) << stamp;
  }
}

TEST(Stamps, AClockBeyond2038Works) {
  for (const double start : {2147483647.9, 3e9, kGreatest - 2.0}) {
    Stand stand(start);
    stand.hold();
    EXPECT_EQ(stand.supervisor.report().status, ControlStatus::kOptimal) << start;
    stand.supervisor.onReference(line(), std::nullopt);
    for (int k = 0; k < 50; ++k) EXPECT_EQ(stand.step().status, ControlStatus::kOptimal) << start;
    EXPECT_NEAR(stand.supervisor.preview().front().position.x(), 0.05, 0.01) << start;
  }
}

TEST(Stamps, AfterASilenceAnyLaterOneIsAnswered) {
  Stand stand;
  stand.hold();
  stand.supervisor.onSilence(stand.state.stamp + 0.2);
  stand.state.stamp += 100.0;
  EXPECT_EQ(stand.step().status, ControlStatus::kOptimal);
  // A node that is to wait for longer still sees the pause.
  for (const double pause : {0.0, 0.3, 0.7}) stand.supervisor.onTime(stand.state.stamp + pause);
  stand.state.stamp += 3.0;
  EXPECT_EQ(stand.step().status, ControlStatus::kOptimal);
  stand.supervisor.onTime(stand.state.stamp);
  EXPECT_EQ(stand.stepAt(stand.state.stamp + 3.0).reason, ControlReason::kOutOfOrder);
}

}  // namespace
