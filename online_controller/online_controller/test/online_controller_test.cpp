#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>

#include "online_controller/laws/multirotor_controller.hpp"
#include "online_support.hpp"
#include "polyfly_base/error.hpp"
#include "project_root.hpp"

namespace {

using polyfly::ControlReason;
using polyfly::ControlReport;
using polyfly::ControlStatus;
using polyfly::MultirotorOptions;
using polyfly::Reference;
using polyfly::VehicleState;
using polyfly_test::Flight;

// Of the project's problem files, restated.
constexpr double kGravity = 9.8066;
constexpr double kDrag = 0.01;
constexpr double kGain = 0.9;
constexpr double kTauPitch = 0.255;
constexpr double kTauRoll = 0.25;
constexpr double kRounding = 1e-12;

MultirotorOptions withoutObserver() {
  MultirotorOptions options;
  options.offset_free = false;
  options.solve_outside = false;
  return options;
}

Eigen::Quaterniond attitudeOf(double roll, double pitch, double yaw) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                            Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                            Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()));
}

void expectLevel(const ControlReport& report) {
  EXPECT_EQ(report.command.roll, 0.0);
  EXPECT_EQ(report.command.pitch, 0.0);
  EXPECT_EQ(report.command.yaw_rate, 0.0);
  EXPECT_EQ(report.command.thrust, 1.52 * kGravity);
}

TEST(MultirotorController, AssemblesTheParametersByHand) {
  Flight flight(withoutObserver());
  VehicleState state;
  state.stamp = 10.0;
  state.position = {1.0, -2.0, 3.0};
  state.velocity = {0.5, 0.25, -0.125};
  state.attitude = attitudeOf(0.05, -0.08, 0.6);
  Reference reference;
  reference.position = {0.75, -1.5, 3.25};
  reference.velocity = {0.4, 0.3, -0.1};
  reference.acceleration = {0.2, -0.3, 0.1};
  reference.jerk = {0.1, 0.2, -0.3};
  const ControlReport& report = flight.controller->step(state, reference);
  ASSERT_EQ(report.status, ControlStatus::kOptimal);
  EXPECT_EQ(report.reason, ControlReason::kNone);
  EXPECT_EQ(report.stamp, 10.0);

  const double world_pitch = std::cos(0.6) * -0.08 + std::sin(0.6) * 0.05;
  const double world_roll = std::cos(0.6) * 0.05 - std::sin(0.6) * -0.08;
  const double pitch_ref = (0.2 + kDrag * 0.4) / kGravity;
  const double pitch_rate_ref = (0.1 + kDrag * 0.2) / kGravity;
  const double roll_ref = -(-0.3 + kDrag * 0.3) / kGravity;
  const double roll_rate_ref = -(0.2 + kDrag * -0.3) / kGravity;
  const double theta_x[] = {0.25, 0.1, world_pitch - pitch_ref, 0.0,
                            (pitch_ref + kTauPitch * pitch_rate_ref) / kGain};
  const double theta_y[] = {-0.5, -0.05, world_roll - roll_ref, 0.0,
                            (roll_ref + kTauRoll * roll_rate_ref) / kGain};
  const double theta_z[] = {-0.25, -0.025, 0.0, 0.1};
  ASSERT_EQ(report.axis[0].size, 5);
  ASSERT_EQ(report.axis[1].size, 5);
  ASSERT_EQ(report.axis[2].size, 4);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(report.axis[0].theta[i], theta_x[i], kRounding) << i;
    EXPECT_NEAR(report.axis[1].theta[i], theta_y[i], kRounding) << i;
  }
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(report.axis[2].theta[i], theta_z[i], kRounding) << i;

  // The inputs by the laws of the made maps, then Eq. 41 after Eq. 40.
  const double theta_cmd = theta_x[4] - 0.3 * theta_x[0] - 0.35 * theta_x[1] - 1.0 * theta_x[2];
  const double phi_cmd = theta_y[4] + 0.3 * theta_y[0] + 0.35 * theta_y[1] - 1.0 * theta_y[2];
  const double lift = theta_z[3] - 4.0 * theta_z[0] - 3.5 * theta_z[1];
  EXPECT_NEAR(report.axis[0].input, theta_cmd, kRounding);
  EXPECT_NEAR(report.axis[1].input, phi_cmd, kRounding);
  EXPECT_NEAR(report.axis[2].input, lift, kRounding);
  const double thrust = (lift + kGravity) / (std::cos(0.05) * std::cos(-0.08));
  EXPECT_NEAR(report.command.thrust, 1.52 * thrust, 1e-10);
  // Loops of Euler angles turn the tilt with the body, which the commands undo.
  const double yaw_rate = 1.8 * (0.0 - 0.6);
  EXPECT_NEAR(report.command.roll,
              kGravity / thrust * (std::cos(0.6) * phi_cmd + std::sin(0.6) * theta_cmd) +
                  kTauRoll / kGain * yaw_rate * -0.08,
              kRounding);
  EXPECT_NEAR(report.command.pitch,
              kGravity / thrust * (std::cos(0.6) * theta_cmd - std::sin(0.6) * phi_cmd) -
                  kTauPitch / kGain * yaw_rate * 0.05,
              kRounding);
  EXPECT_NEAR(report.command.yaw_rate, 1.8 * (0.0 - 0.6), kRounding);

  // The next step's previous inputs are these inputs.
  state.stamp += 0.01;
  const std::array<double, 3> last{report.axis[0].input, report.axis[1].input, report.axis[2].input};
  flight.controller->step(state, reference);
  EXPECT_EQ(flight.controller->report().axis[0].theta[3], last[0]);
  EXPECT_EQ(flight.controller->report().axis[1].theta[3], last[1]);
  EXPECT_EQ(flight.controller->report().axis[2].theta[2], last[2]);
}

TEST(MultirotorController, HoversAtTheReference) {
  Flight flight;
  const ControlReport& report = flight.controller->step(VehicleState{}, Reference{});
  EXPECT_EQ(report.status, ControlStatus::kOptimal);
  EXPECT_NEAR(report.command.roll, 0.0, kRounding);
  EXPECT_NEAR(report.command.pitch, 0.0, kRounding);
  EXPECT_NEAR(report.command.thrust, 1.52 * kGravity, kRounding);
}

TEST(MultirotorController, WithoutErrorADisturbanceGivesTheInputReference) {
  // The vehicle stands still at its reference for ever, whatever is commanded: an unknown force must cancel
  // the commands. The estimate moves until model and vehicle agree; the command is then what that force
  // demands.
  Flight flight;
  VehicleState state;
  state.attitude = attitudeOf(0.0, 0.1, 0.0);  // leans into the wind
  for (int k = 0; k < 2000; ++k) {
    state.stamp = 0.01 * k;
    flight.controller->step(state, Reference{});
  }
  const ControlReport& report = flight.controller->report();
  ASSERT_EQ(report.status, ControlStatus::kOptimal);
  EXPECT_EQ(report.axis[0].theta[0], 0.0);
  // v' = 0 = g theta + d with theta = 0.1, up to what the command being held back from 0.1 / K leaves of it.
  EXPECT_LT(report.axis[0].disturbance, -0.5);
  // The angle is the force of the rotors over g, under the thrust that was sent.
  const double angle = 0.1 * report.command.thrust / (1.52 * kGravity);
  EXPECT_NEAR(report.axis[0].theta[2], angle + report.axis[0].disturbance / kGravity, 1e-9);
  EXPECT_NEAR(report.axis[0].theta[4], -report.axis[0].disturbance / kGravity / kGain, kRounding);
  EXPECT_NEAR(report.axis[0].input, report.axis[0].theta[4] - report.axis[0].theta[2], kRounding);
  EXPECT_NEAR(report.axis[1].disturbance, 0.0, 1e-9);
  EXPECT_NEAR(report.axis[2].theta[3], -report.axis[2].disturbance, kRounding);
}

TEST(MultirotorController, YawRateLaw) {
  Flight flight;
  VehicleState state;
  Reference reference;
  state.attitude = attitudeOf(0.0, 0.0, 3.0);
  reference.yaw = -3.0;
  reference.yaw_rate = 0.1;
  // The shorter way leads through pi.
  EXPECT_NEAR(flight.controller->step(state, reference).command.yaw_rate,
              1.8 * (2.0 * 3.14159265358979323846 - 6.0) + 0.1, 1e-9);
  reference.yaw = 1.0;
  EXPECT_EQ(flight.controller->step(state, reference).command.yaw_rate, -MultirotorOptions{}.yaw_rate_max);
}

TEST(MultirotorController, WhatIsSentRespectsItsLimits) {
  Flight flight;
  VehicleState state;
  Reference reference;
  for (const double x : {-2.9, 2.9}) {
    for (const double y : {-2.9, 2.9}) {
      for (const double z : {-2.9, 2.9}) {
        flight.controller->reset();
        state.position = {x, y, z};
        state.attitude = attitudeOf(0.4, -0.4, 0.7);
        const ControlReport& report = flight.controller->step(state, reference);
        EXPECT_LE(std::abs(report.command.roll), MultirotorOptions{}.angle_max);
        EXPECT_LE(std::abs(report.command.pitch), MultirotorOptions{}.angle_max);
        EXPECT_GE(report.command.thrust, 1.52 * 5.0);
        EXPECT_LE(report.command.thrust, 1.52 * 20.0);
        for (std::size_t i = 0; i < 2; ++i) EXPECT_LE(std::abs(report.axis[i].input), 0.4363323);
      }
    }
  }
}

TEST(MultirotorController, OutsideTheBoxIsClippedAndSaysWhich) {
  Flight flight(withoutObserver());
  VehicleState state;
  state.position = {0.0, 5.0, 0.0};  // e_p_y up to 3 m
  const ControlReport& report = flight.controller->step(state, Reference{});
  EXPECT_EQ(report.status, ControlStatus::kClipped);
  EXPECT_EQ(report.reason, ControlReason::kOutsideBox);
  EXPECT_EQ(report.axis[1].lookup, polyfly::LookupStatus::kOutsideBox);
  EXPECT_EQ(report.axis[1].outside_parameter, 0);
  // theta is the parameter as assembled, before clipping.
  EXPECT_EQ(report.axis[1].theta[0], 5.0);
  EXPECT_EQ(report.axis[1].region, 0);
  EXPECT_EQ(report.axis[1].input, 0.4363323);  // 0.3 * 3 at its bound
  EXPECT_EQ(report.axis[0].outside_parameter, -1);
  EXPECT_EQ(report.axis[0].lookup, polyfly::LookupStatus::kInside);
}

TEST(MultirotorController, AnInputReferenceBeyondItsRangeIsClipped) {
  Flight flight(withoutObserver());
  Reference reference;
  reference.acceleration = {4.0, 0.0, 0.0};  // asks for 0.45 rad, range 0.25 rad
  const ControlReport& report = flight.controller->step(VehicleState{}, reference);
  EXPECT_EQ(report.status, ControlStatus::kClipped);
  EXPECT_EQ(report.axis[0].outside_parameter, 4);
  EXPECT_NEAR(report.axis[0].theta[4], (4.0 + kTauPitch * kDrag * 4.0) / kGravity / kGain, kRounding);
}

TEST(MultirotorController, OutsideThePartitionHoldsThenLevels) {
  std::array<polyfly::MapContent, 3> contents = polyfly_test::axisContents();
  polyfly_test::cutOff(contents[0], 0, 1.0);  // infeasible above e_p_x = 1
  MultirotorOptions options = withoutObserver();
  options.hold_periods = 3;
  Flight flight(contents, options);
  VehicleState good;
  good.position.x() = 0.5;
  VehicleState bad = good;
  bad.position.x() = 2.0;
  const polyfly::AttitudeCommand last = flight.controller->step(good, Reference{}).command;
  const double last_input = flight.controller->report().axis[0].input;
  for (int k = 1; k <= 5; ++k) {
    bad.stamp = 0.01 * k;
    const ControlReport& report = flight.controller->step(bad, Reference{});
    EXPECT_EQ(report.reason, ControlReason::kOutsidePartition);
    EXPECT_EQ(report.axis[0].lookup, polyfly::LookupStatus::kOutsidePartition);
    EXPECT_EQ(report.axis[0].region, -1);
    EXPECT_EQ(report.axis[0].theta[0], 2.0);
    if (k <= 3) {
      EXPECT_EQ(report.status, ControlStatus::kHoldLast) << k;
      EXPECT_EQ(report.command.pitch, last.pitch);
      EXPECT_EQ(report.command.thrust, last.thrust);
      EXPECT_EQ(report.axis[0].input, last_input);
    } else {
      EXPECT_EQ(report.status, ControlStatus::kLevel) << k;
      expectLevel(report);
    }
  }
  good.stamp = 0.06;
  const ControlReport& report = flight.controller->step(good, Reference{});
  EXPECT_EQ(report.status, ControlStatus::kOptimal);
  // The level command was applied before.
  EXPECT_EQ(report.axis[0].theta[3], 0.0);
}

TEST(MultirotorController, ClippedIntoAnInfeasiblePlaceHasNoAnswer) {
  std::array<polyfly::MapContent, 3> contents = polyfly_test::axisContents();
  polyfly_test::cutOff(contents[0], 0, 1.0);
  MultirotorOptions options;
  options.solve_outside = false;
  Flight flight(contents, options);
  VehicleState state;
  state.position.x() = 7.0;
  const ControlReport& report = flight.controller->step(state, Reference{});
  EXPECT_EQ(report.status, ControlStatus::kLevel);  // there is no command to repeat
  EXPECT_EQ(report.reason, ControlReason::kOutsidePartition);
  EXPECT_EQ(report.axis[0].outside_parameter, 0);
  expectLevel(report);
}

TEST(MultirotorController, WithoutReferenceItStaysLevel) {
  Flight flight;
  const ControlReport& report = flight.controller->stepWithoutReference(4.0);
  EXPECT_EQ(report.status, ControlStatus::kNoReference);
  EXPECT_EQ(report.reason, ControlReason::kNoReference);
  EXPECT_EQ(report.stamp, 4.0);
  expectLevel(report);
}

TEST(MultirotorController, SilenceLevelsAtOnceAndEnds) {
  Flight flight;
  VehicleState state;
  state.position.x() = 0.5;
  flight.controller->step(state, Reference{});
  const ControlReport& report = flight.controller->onSilence(0.2);
  EXPECT_EQ(report.status, ControlStatus::kLevel);
  EXPECT_EQ(report.reason, ControlReason::kStale);
  EXPECT_EQ(report.stamp, 0.2);
  expectLevel(report);
  state.stamp = 0.3;
  EXPECT_EQ(flight.controller->step(state, Reference{}).status, ControlStatus::kOptimal);
  EXPECT_NE(flight.controller->report().command.pitch, 0.0);
}

TEST(MultirotorOptions, ValuesOutOfRangeAreNamed) {
  const auto refusal = [](auto change) -> std::string {
    MultirotorOptions options;
    change(options);
    try {
      polyfly::checkOptions(options);
      return {};
    } catch (const polyfly::Error& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refusal([](MultirotorOptions&) {}), "");
  EXPECT_EQ(refusal([](MultirotorOptions& o) { o.mass = 0.0; }).rfind("vehicle/mass: must lie in [", 0), 0u);
  EXPECT_EQ(refusal([](MultirotorOptions& o) { o.hold_periods = -1; }).rfind("controller/hold_periods:", 0),
            0u);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal([&](MultirotorOptions& o) { o.yaw_gain = nan; }).rfind("controller/yaw_gain:", 0), 0u);
  EXPECT_NE(refusal([](MultirotorOptions& o) { o.thrust_min = 10.0; }).find("hover"), std::string::npos);
  EXPECT_THROW(Flight([] {
                 MultirotorOptions options;
                 options.angle_max = 3.0;
                 return options;
               }()),
               polyfly::Error);
}

TEST(MultirotorOptions, TheReadmeListsEachKey) {
  std::ifstream stream(polyfly::projectRoot() + "/online_controller/README.md");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  MultirotorOptions options;
  int count = 0;
  polyfly::visitOptions(options, [&](const char* key, auto&&...) {
    EXPECT_NE(text.find("`" + std::string(key) + "`"), std::string::npos) << key;
    ++count;
  });
  EXPECT_EQ(count, 37);
}

TEST(MultirotorController, AMissingMapIsNamed) {
  const polyfly_test::MapInMemory longitudinal(polyfly_test::axisContent(0));
  try {
    const polyfly::MultirotorController controller({&longitudinal.map(), nullptr, nullptr}, {});
    FAIL() << "no error";
  } catch (const polyfly::Error& error) {
    EXPECT_STREQ(error.what(), "lateral map: missing");
  }
}

}  // namespace
