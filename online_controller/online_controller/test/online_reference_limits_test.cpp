// References that ask for more than the limits, before and after the first odometry.
#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "allocations.hpp"
#include "online_controller/flight/flight_supervisor.hpp"
#include "online_controller/reference/reference_excess.hpp"
#include "online_support.hpp"
#include "polyfly_base/error.hpp"

namespace {

using polyfly::ControlStatus;
using polyfly::FlightState;
using polyfly::ReferenceLimits;
using polyfly::ReferenceTrajectory;

constexpr double kFar = 1e5;  // [m]
const Eigen::Vector3d kHere(200.0, -100.0, 400.0);

ReferenceTrajectory poseAt(double x, double y, double z) {
  return ReferenceTrajectory::pose(kHere + Eigen::Vector3d(x, y, z), 0.0);
}

/// Points along x, a second apart; at rest in each, or with the velocities of the spline.
ReferenceTrajectory along(const std::vector<double>& places, bool at_rest = false) {
  std::vector<polyfly::TrajectorySample> samples(places.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].time = static_cast<double>(i);
    samples[i].position = kHere + Eigen::Vector3d(places[i], 0.0, 0.0);
    samples[i].has_velocity = samples[i].has_acceleration = at_rest;
  }
  return ReferenceTrajectory(std::move(samples));
}

std::string excess(const ReferenceTrajectory& trajectory) {
  const polyfly::ReferenceExcess found = polyfly::findExcess(trajectory, &kHere, ReferenceLimits{});
  return found.limit == nullptr ? "" : polyfly::describe(found);
}

TEST(ReferenceLimits, APoseIsCountedFromTheVehicle) {
  EXPECT_EQ(excess(poseAt(0.0, 0.0, 0.0)), "");
  EXPECT_EQ(excess(poseAt(600.0, -600.0, 490.0)), "");
  EXPECT_EQ(excess(poseAt(0.0, -1200.0, 0.0)),
            "pose: lies 1200 m from the vehicle, more than reference_limits/distance, 1000 m");
}

TEST(ReferenceLimits, EachPointOfATrajectoryCounts) {
  EXPECT_EQ(excess(along({0.0, 20.0, 40.0, 60.0})), "");
  std::vector<double> places(60);
  for (std::size_t i = 0; i < places.size(); ++i) places[i] = 20.0 * static_cast<double>(i);
  EXPECT_EQ(
      excess(along(places)),
      "trajectory: sample 51: lies 1020 m from the vehicle, more than reference_limits/distance, 1000 m");
}

TEST(ReferenceLimits, TheSpeedCountsAtThePointsAndBetweenThem) {
  EXPECT_EQ(excess(along({0.0, 29.0, 58.0, 87.0})), "");
  EXPECT_EQ(excess(along({0.0, 40.0, 80.0, 120.0})),
            "trajectory: sample 0: asks for 40 m/s, more than reference_limits/speed, 30 m/s");
  // From rest to rest the greatest speed is 15/8 of the mean.
  EXPECT_EQ(excess(along({0.0, 15.9}, true)), "");
  EXPECT_EQ(excess(along({0.0, 0.0, 24.0}, true)),
            "trajectory: sample 1: asks for 45 m/s, more than reference_limits/speed, 30 m/s");
}

TEST(ReferenceLimits, ALimitThatIsNoRangeIsRefusedAtTheStart) {
  polyfly_test::Flight law;
  polyfly::FlightOptions options;
  options.reference_limits.speed = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(polyfly::FlightSupervisor(*law.controller, {}, options), polyfly::Error);
}

struct Flight {
  polyfly_test::Flight law;
  polyfly::FlightSupervisor supervisor{*law.controller, polyfly::MultirotorOptions{},
                                       polyfly::FlightOptions{}};
  polyfly::VehicleState state;

  Flight() { state.position = kHere; }

  ControlStatus step() {
    state.stamp += 0.01;
    return supervisor.onOdometry(state).status;
  }

  void expectRefused(ReferenceTrajectory trajectory) {
    EXPECT_THROW(supervisor.onReference(std::move(trajectory), std::nullopt), polyfly::Error);
  }
};

TEST(ReferenceLimits, WhatIsRefusedLeavesTheReferenceInForce) {
  Flight flight;
  flight.step();
  ASSERT_EQ(flight.supervisor.onReference(poseAt(0.1, 0.0, 0.0), std::nullopt), nullptr);
  EXPECT_EQ(flight.step(), ControlStatus::kOptimal);
  flight.expectRefused(poseAt(kFar, 0.0, 0.0));
  flight.expectRefused(along({0.0, 10.0, kFar}));
  flight.expectRefused(along({kFar}));
  EXPECT_EQ(flight.step(), ControlStatus::kOptimal);
  EXPECT_EQ(flight.supervisor.preview().front().position, kHere + Eigen::Vector3d(0.1, 0.0, 0.0));
}

TEST(ReferenceLimits, WhatCameBeforeTheFirstOdometryIsJudgedByIt) {
  Flight flight;
  flight.expectRefused(along({0.0, 10.0, kFar}));  // a speed needs no odometry
  ASSERT_EQ(flight.supervisor.onReference(poseAt(kFar, 0.0, 0.0), std::nullopt), nullptr);
  EXPECT_EQ(flight.supervisor.state(), FlightState::kPositionHold);
  const long before = polyfly_test::allocationCount();
  EXPECT_EQ(flight.step(), ControlStatus::kNoReference);
  EXPECT_EQ(polyfly_test::allocationCount(), before);
  EXPECT_EQ(flight.supervisor.state(), FlightState::kInactive);
  EXPECT_STREQ(flight.supervisor.earlyExcess().limit, "reference_limits/distance");
  EXPECT_EQ(flight.supervisor.onReference(poseAt(0.0, 0.0, 0.0), std::nullopt), nullptr);
  EXPECT_EQ(flight.step(), ControlStatus::kOptimal);

  Flight near;
  ASSERT_EQ(near.supervisor.onReference(poseAt(0.0, 0.0, 0.0), std::nullopt), nullptr);
  EXPECT_EQ(near.step(), ControlStatus::kOptimal);
  EXPECT_EQ(near.supervisor.earlyExcess().limit, nullptr);
}

TEST(ReferenceLimits, WhatCameBeforeOdometryThatWasBadIsJudgedByTheFirstGoodOne) {
  Flight flight;
  ASSERT_EQ(flight.supervisor.onReference(poseAt(kFar, 0.0, 0.0), std::nullopt), nullptr);
  polyfly::VehicleState bad = flight.state;
  bad.position.x() = std::numeric_limits<double>::quiet_NaN();
  for (int k = 0; k < 20; ++k) flight.supervisor.onOdometry(bad);
  EXPECT_EQ(flight.supervisor.state(), FlightState::kFailsafe);
  EXPECT_EQ(flight.step(), ControlStatus::kNoReference);
  EXPECT_EQ(flight.supervisor.state(), FlightState::kInactive);
}

}  // namespace
