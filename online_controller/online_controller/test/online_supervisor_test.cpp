// Flights from take-off to landing, with everything that comes between, on a vehicle that stands on a floor.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "allocations.hpp"
#include "online_controller/flight/flight_supervisor.hpp"
#include "online_support.hpp"
#include "polyfly_base/error.hpp"

namespace {

using polyfly::ControlReason;
using polyfly::ControlReport;
using polyfly::ControlStatus;
using polyfly::FlightState;
using polyfly::ReferenceTrajectory;
using polyfly::RemoteControl;

constexpr double kGravity = 9.8066;
constexpr double kMass = 1.52;
constexpr double kPeriod = 0.01;
const double kNan = std::numeric_limits<double>::quiet_NaN();

struct Room {
  explicit Room(const polyfly::FlightOptions& options = {}, const polyfly::MultirotorOptions& vehicle = {},
                polyfly::PilotRule pilot = polyfly::PilotRule::kWhenPresent)
      : law(vehicle), supervisor(*law.controller, vehicle, options, pilot) {}

  /// A point mass that leans at once, above a floor at height 0.
  void move(const polyfly::AttitudeCommand& command) {
    const double thrust = command.thrust / kMass;
    const Eigen::Quaterniond attitude(Eigen::AngleAxisd(command.pitch, Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(command.roll, Eigen::Vector3d::UnitX()));
    state.attitude = attitude;
    const Eigen::Vector3d acceleration =
        attitude * Eigen::Vector3d(0.0, 0.0, thrust) - Eigen::Vector3d(0.0, 0.0, kGravity);
    state.velocity += kPeriod * acceleration;
    state.position += kPeriod * state.velocity;
    if (state.position.z() <= 0.0) {
      state.position.z() = 0.0;
      state.velocity.setZero();
    }
    state.stamp += kPeriod;
  }

  const ControlReport& step() {
    const ControlReport& report = supervisor.onOdometry(state);
    EXPECT_TRUE(std::isfinite(report.command.thrust));
    if (supervisor.sends()) move(report.command);
    return report;
  }

  void run(double seconds) {
    for (int k = 0; k < std::lround(seconds / kPeriod); ++k) step();
  }

  /// The vehicle hovers at a pose that was asked for.
  void hover(const Eigen::Vector3d& position) {
    state.position = position;
    run(0.05);
    EXPECT_EQ(supervisor.onReference(ReferenceTrajectory::pose(position, 0.0), std::nullopt), nullptr);
    run(1.0);
    EXPECT_EQ(supervisor.state(), FlightState::kPositionHold);
  }

  polyfly_test::Flight law;
  polyfly::FlightSupervisor supervisor;
  polyfly::VehicleState state;
};

RemoteControl stick(RemoteControl::Mode mode) {
  RemoteControl sticks;
  sticks.on = true;
  sticks.mode = mode;
  return sticks;
}

ReferenceTrajectory line(double length, double duration) {
  std::vector<polyfly::TrajectorySample> samples(2);
  samples[0].position = {0.0, 0.0, 1.0};
  samples[1].position = {length, 0.0, 1.0};
  samples[1].time = duration;
  for (auto& sample : samples) sample.has_velocity = sample.has_acceleration = true;
  return ReferenceTrajectory(std::move(samples));
}

TEST(Supervisor, AReferenceAloneStartsAFlightAsEver) {
  Room room;
  EXPECT_EQ(room.step().status, ControlStatus::kNoReference);
  EXPECT_EQ(room.supervisor.state(), FlightState::kInactive);
  EXPECT_FALSE(room.supervisor.sends());
  room.hover({0.0, 0.0, 1.0});
  EXPECT_EQ(room.supervisor.report().status, ControlStatus::kOptimal);
}

TEST(Supervisor, TakesOffHoldsAndLands) {
  Room room;
  room.state.position = {2.0, -1.0, 0.0};
  EXPECT_STREQ(room.supervisor.takeOff(), "there is no fresh odometry");
  room.step();
  room.state.position = {2.0, -1.0, 0.0};
  ASSERT_EQ(room.supervisor.takeOff(), nullptr);
  EXPECT_EQ(room.supervisor.state(), FlightState::kTakeOff);
  double fastest = 0.0;
  for (int k = 0; k < 450; ++k) {
    room.step();
    fastest = std::max(fastest, room.state.velocity.z());
  }
  EXPECT_EQ(room.supervisor.state(), FlightState::kTakeOff);
  // The quintic over 1 m in 5 s reaches 0.375 m/s.
  EXPECT_LT(fastest, 0.6);
  room.run(1.5);
  EXPECT_EQ(room.supervisor.state(), FlightState::kPositionHold);
  EXPECT_NEAR(room.state.position.z(), 1.0, 0.1);
  EXPECT_NEAR(room.state.position.x(), 2.0, 0.1);

  ASSERT_EQ(room.supervisor.land(), nullptr);
  room.run(1.0);
  EXPECT_EQ(room.supervisor.state(), FlightState::kLanding);
  EXPECT_NEAR(room.state.velocity.z(), -0.5, 0.1);
  room.run(5.0);
  EXPECT_EQ(room.supervisor.state(), FlightState::kLanded);
  EXPECT_EQ(room.supervisor.report().status, ControlStatus::kMotorsOff);
  EXPECT_EQ(room.supervisor.report().command.thrust, 0.0);
  EXPECT_STREQ(room.supervisor.onReference(line(1.0, 2.0), std::nullopt), "it has landed: take off first");
  room.supervisor.onSilence(100.0);
  EXPECT_EQ(room.supervisor.report().command.thrust, 0.0);
  room.run(0.1);
  ASSERT_EQ(room.supervisor.takeOff(), nullptr);
  room.run(6.5);
  EXPECT_NEAR(room.state.position.z(), 1.0, 0.1);
}

TEST(Supervisor, ATakeOffThatDoesNotRiseEndsOnTheGround) {
  Room room;
  room.step();
  ASSERT_EQ(room.supervisor.takeOff(), nullptr);
  for (int k = 0; k < 1200; ++k) {
    room.state.stamp += kPeriod;
    room.supervisor.onOdometry(room.state);
    if (room.supervisor.state() == FlightState::kLanding) break;
  }
  EXPECT_EQ(room.supervisor.state(), FlightState::kLanding);
  EXPECT_EQ(room.supervisor.cause(), polyfly::FlightEvent::kTakeOffFailed);
  room.run(5.0);
  EXPECT_EQ(room.supervisor.state(), FlightState::kLanded);
}

TEST(Supervisor, AReferenceThatComesInTheTakeOffIsFlownAfterIt) {
  Room room;
  room.step();
  ASSERT_EQ(room.supervisor.takeOff(), nullptr);
  room.run(1.0);
  ASSERT_EQ(room.supervisor.onReference(line(1.0, 2.0), std::nullopt), nullptr);
  room.run(2.0);
  EXPECT_EQ(room.supervisor.state(), FlightState::kTakeOff);
  room.run(3.0);
  EXPECT_EQ(room.supervisor.state(), FlightState::kTrajectory);
  room.run(3.0);
  EXPECT_EQ(room.supervisor.state(), FlightState::kPositionHold);
  EXPECT_EQ(room.supervisor.cause(), polyfly::FlightEvent::kTrajectoryEnded);
  EXPECT_NEAR(room.state.position.x(), 1.0, 0.15);
}

TEST(Supervisor, HoldStopsOnTheWay) {
  Room room;
  room.hover({0.0, 0.0, 1.0});
  room.supervisor.onReference(line(10.0, 10.0), std::nullopt);
  room.run(5.0);
  EXPECT_EQ(room.supervisor.state(), FlightState::kTrajectory);
  const double x = room.state.position.x(), v = room.state.velocity.x();
  EXPECT_GT(v, 1.0);
  ASSERT_EQ(room.supervisor.holdPosition(), nullptr);
  room.run(6.0);
  EXPECT_EQ(room.supervisor.state(), FlightState::kPositionHold);
  EXPECT_NEAR(room.state.position.x(), x + v * v / 4.0, 0.1);
}

TEST(Supervisor, SticksMoveTheHoldAndManualIsThePilots) {
  Room room;
  room.hover({0.0, 0.0, 2.0});
  RemoteControl sticks = stick(RemoteControl::Mode::kPosition);
  room.supervisor.onRemoteControl(sticks, room.state.stamp);
  EXPECT_EQ(room.supervisor.state(), FlightState::kPositionHold);
  sticks.forward = 1.0;
  for (int k = 0; k < 200; ++k) {
    room.supervisor.onRemoteControl(sticks, room.state.stamp);
    room.step();
  }
  EXPECT_EQ(room.supervisor.state(), FlightState::kTeleoperation);
  EXPECT_GT(room.state.position.x(), 0.5);
  EXPECT_NEAR(room.state.position.z(), 2.0, 0.2);
  EXPECT_STREQ(room.supervisor.onReference(line(1.0, 1.0), std::nullopt),
               "the remote control has the vehicle");
  // In the dead zone, the pose that was reached is held.
  sticks.forward = 0.05;
  const double reached = room.supervisor.preview().front().position.x();
  for (int k = 0; k < 400; ++k) {
    room.supervisor.onRemoteControl(sticks, room.state.stamp);
    room.step();
  }
  EXPECT_NEAR(room.state.position.x(), reached, 0.1);

  sticks = stick(RemoteControl::Mode::kManual);
  sticks.left = -0.5;
  sticks.up = 0.25;
  EXPECT_TRUE(room.supervisor.onRemoteControl(sticks, room.state.stamp));
  EXPECT_EQ(room.supervisor.state(), FlightState::kRemoteControl);
  const ControlReport manual = room.supervisor.report();
  EXPECT_EQ(manual.status, ControlStatus::kManual);
  EXPECT_NEAR(manual.command.roll, 0.5 * 0.78539816, 1e-12);
  EXPECT_NEAR(manual.command.thrust, kMass * kGravity, 1e-9);  // 0.625 of 1.6
  EXPECT_STREQ(room.supervisor.takeOff(), "the remote control has the vehicle");

  // The switch hands over to a hold where it is.
  sticks = stick(RemoteControl::Mode::kPosition);
  room.supervisor.onRemoteControl(sticks, room.state.stamp);
  EXPECT_EQ(room.supervisor.state(), FlightState::kPositionHold);
  EXPECT_EQ(room.step().status, ControlStatus::kOptimal);
}

TEST(Supervisor, APilotWhoFallsSilentInManualFlightLands) {
  Room room;
  room.hover({0.0, 0.0, 2.0});
  RemoteControl sticks = stick(RemoteControl::Mode::kManual);
  sticks.up = 0.25;
  room.supervisor.onRemoteControl(sticks, room.state.stamp);
  EXPECT_EQ(room.supervisor.state(), FlightState::kRemoteControl);
  for (int k = 0; k < 120; ++k) {
    room.step();
    room.supervisor.onTime(room.state.stamp);
  }
  EXPECT_EQ(room.supervisor.state(), FlightState::kLanding);
  EXPECT_EQ(room.supervisor.cause(), polyfly::FlightEvent::kPilotLost);
  room.run(8.0);
  EXPECT_EQ(room.supervisor.state(), FlightState::kLanded);
}

TEST(Supervisor, APilotWhoFallsSilentWithoutOdometryEndsInFailsafeAndLandsWhenItIsBack) {
  Room room;
  room.hover({0.0, 0.0, 1.0});
  RemoteControl sticks = stick(RemoteControl::Mode::kManual);
  sticks.up = 0.25;
  room.supervisor.onRemoteControl(sticks, room.state.stamp);
  room.step();
  room.supervisor.onSilence(room.state.stamp + 0.2);
  sticks.on = false;
  room.supervisor.onRemoteControl(sticks, room.state.stamp + 0.3);
  EXPECT_EQ(room.supervisor.state(), FlightState::kFailsafe);
  room.step();
  EXPECT_EQ(room.supervisor.state(), FlightState::kLanding);
}

TEST(Supervisor, APresentPilotMustHandOverBeforeAnythingStarts) {
  Room room;
  room.step();
  room.supervisor.onRemoteControl(stick(RemoteControl::Mode::kPosition), 0.0);
  EXPECT_STREQ(room.supervisor.takeOff(), "the remote control has the vehicle");
  EXPECT_STREQ(room.supervisor.onReference(line(1.0, 1.0), std::nullopt),
               "the remote control has the vehicle");
  Room without({}, {}, polyfly::PilotRule::kNotRequired);
  without.step();
  without.supervisor.onRemoteControl(stick(RemoteControl::Mode::kPosition), 0.0);
  EXPECT_EQ(without.supervisor.takeOff(), nullptr);
  Room demanded({}, {}, polyfly::PilotRule::kRequired);
  demanded.step();
  EXPECT_STREQ(demanded.supervisor.takeOff(), "the remote control has the vehicle");
}

TEST(Supervisor, TheLadderIsClimbedDownInSilenceAndEnds) {
  polyfly::MultirotorOptions vehicle;
  vehicle.level_periods = 3;
  vehicle.descend_periods = 4;
  Room room({}, vehicle);
  room.hover({0.0, 0.0, 1.0});
  for (int k = 1; k <= 9; ++k) {
    const ControlReport& report = room.supervisor.onSilence(room.state.stamp + 0.1 + kPeriod * k);
    EXPECT_EQ(report.reason, ControlReason::kStale);
    EXPECT_EQ(report.status, k <= 3   ? ControlStatus::kLevel
                             : k <= 7 ? ControlStatus::kDescend
                                      : ControlStatus::kStopped);
    EXPECT_EQ(room.supervisor.sends(), k <= 7);
    EXPECT_EQ(report.command.pitch, 0.0);
    EXPECT_EQ(report.command.thrust, kMass * (k <= 3 ? 1.0 : 0.95) * kGravity);
    EXPECT_EQ(room.supervisor.state(), FlightState::kFailsafe);
  }
  room.state.stamp += 0.3;
  EXPECT_EQ(room.step().status, ControlStatus::kOptimal);
  EXPECT_EQ(room.supervisor.state(), FlightState::kPositionHold);
  EXPECT_TRUE(room.supervisor.sends());
}

TEST(Supervisor, RefusedOdometryHoldsThenLevelsAndSaysWhy) {
  const auto refused = [](auto spoil, ControlReason reason, bool frame_fits) {
    Room room;
    room.hover({0.0, 0.0, 1.0});
    const polyfly::AttitudeCommand last = room.supervisor.report().command;
    for (int k = 1; k <= 10; ++k) {
      polyfly::VehicleState bad = room.state;
      spoil(bad, k);
      const ControlReport& report = room.supervisor.onOdometry(bad, frame_fits);
      EXPECT_EQ(report.status, ControlStatus::kHoldLast) << k;
      EXPECT_EQ(report.reason, reason);
      EXPECT_EQ(report.command.thrust, last.thrust);
      EXPECT_EQ(room.supervisor.state(), FlightState::kPositionHold);
      room.state.stamp += kPeriod;
    }
    EXPECT_EQ(room.step().status, ControlStatus::kOptimal);
  };
  refused([](auto& state, int) { state.position.x() = kNan; }, ControlReason::kNotFinite, true);
  refused([](auto& state, int) { state.position.y() += 5.0; }, ControlReason::kJump, true);
  const auto turn = [](auto& state, int) {
    state.attitude = Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ())) * state.attitude;
  };
  refused(turn, ControlReason::kJump, true);
  refused([](auto& state, int k) { state.stamp -= 0.5 + kPeriod * k; }, ControlReason::kOutOfOrder, true);
  refused([](auto&, int) {}, ControlReason::kWrongFrame, false);
}

TEST(Supervisor, AWrongFrameForLongEndsInFailsafe) {
  Room room;
  room.hover({0.0, 0.0, 1.0});
  for (int k = 0; k < 11; ++k) {
    room.state.stamp += kPeriod;
    room.supervisor.onOdometry(room.state, false);
  }
  EXPECT_EQ(room.supervisor.state(), FlightState::kFailsafe);
  EXPECT_EQ(room.supervisor.cause(), polyfly::FlightEvent::kBadOdometry);
  EXPECT_EQ(room.supervisor.report().status, ControlStatus::kLevel);
}

TEST(Supervisor, AJumpThatLastsIsBelievedInTheEnd) {
  Room room;
  room.hover({0.0, 0.0, 1.0});
  room.state.position.x() += 2.0;
  int held = 0;
  while (room.supervisor.onOdometry(room.state).reason == ControlReason::kJump && held < 100) {
    room.state.stamp += kPeriod;
    ++held;
  }
  EXPECT_EQ(held, 10);
  EXPECT_EQ(room.supervisor.report().status, ControlStatus::kOptimal);
  EXPECT_LT(room.supervisor.report().command.pitch, -0.1);  // back to where it is to hold
  // The observer does not take the jump for wind.
  EXPECT_LT(std::abs(room.supervisor.report().axis[0].disturbance), 0.05);
  room.run(8.0);
  EXPECT_NEAR(room.state.position.x(), 0.0, 0.1);
}

TEST(Supervisor, OdometryThatStandsStillWhileItMovesIsSilence) {
  Room room;
  room.hover({0.0, 0.0, 1.0});
  room.state.velocity.x() = 0.3;
  int answered = 0;
  while (room.supervisor.onOdometry(room.state).reason != ControlReason::kStale && answered < 100) {
    room.state.stamp += kPeriod;
    ++answered;
  }
  EXPECT_NEAR(answered, 11, 1);
  EXPECT_EQ(room.supervisor.report().status, ControlStatus::kLevel);
  EXPECT_EQ(room.supervisor.state(), FlightState::kFailsafe);
  EXPECT_EQ(room.supervisor.lastRefusal(), ControlReason::kStale);
  room.state.position.x() += 1e-3;  // it goes on
  room.state.velocity.x() = 0.0;
  EXPECT_EQ(room.step().status, ControlStatus::kOptimal);
  EXPECT_EQ(room.supervisor.state(), FlightState::kPositionHold);
}

TEST(Supervisor, OptionsChangedInFlightReachTheGate) {
  Room room;
  room.hover({0.0, 0.0, 1.0});
  polyfly::MultirotorOptions options;
  options.jump_distance = 10.0;
  options.jump_angle = 0.0;
  room.supervisor.setLaw(*room.law.controller, options);
  room.state.position.y() += 1.0;
  room.state.attitude = Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ()) * room.state.attitude;
  EXPECT_EQ(room.supervisor.onOdometry(room.state).reason, ControlReason::kNone);
}

TEST(Supervisor, ALawWithoutAnswerEndsInFailsafeAndTheNextAnswerEndsIt) {
  std::array<polyfly::MapContent, 3> contents = polyfly_test::axisContents();
  polyfly_test::cutOff(contents[0], 0, 1.0);  // infeasible above e_p_x = 1
  polyfly::MultirotorOptions options;
  options.solve_outside = false;
  polyfly_test::Flight law(contents, options);
  polyfly::FlightSupervisor supervisor(*law.controller, {}, {});
  polyfly::VehicleState state;
  supervisor.onOdometry(state);
  supervisor.onReference(ReferenceTrajectory::pose({0.0, 0.0, 0.0}, 0.0), std::nullopt);
  state.stamp += kPeriod;
  EXPECT_EQ(supervisor.onOdometry(state).status, ControlStatus::kOptimal);
  supervisor.onReference(ReferenceTrajectory::pose({-2.0, 0.0, 0.0}, 0.0), std::nullopt);
  for (int k = 1; k <= 11; ++k) {
    state.stamp += kPeriod;
    const ControlReport& report = supervisor.onOdometry(state);
    EXPECT_EQ(report.reason, ControlReason::kOutsidePartition);
    EXPECT_EQ(report.status, k <= 10 ? ControlStatus::kHoldLast : ControlStatus::kLevel);
  }
  EXPECT_EQ(supervisor.state(), FlightState::kFailsafe);
  EXPECT_EQ(supervisor.cause(), polyfly::FlightEvent::kNoAnswer);
  supervisor.onReference(ReferenceTrajectory::pose({-0.5, 0.0, 0.0}, 0.0), std::nullopt);
  state.stamp += kPeriod;
  EXPECT_EQ(supervisor.onOdometry(state).status, ControlStatus::kOptimal);
  EXPECT_EQ(supervisor.state(), FlightState::kPositionHold);
}

TEST(Supervisor, AfterAFailsafeItGoesOnOrStays) {
  for (const bool resume : {true, false}) {
    polyfly::FlightOptions options;
    options.resume = resume;
    Room room(options);
    room.hover({0.0, 0.0, 1.0});
    room.supervisor.onReference(line(2.0, 4.0), std::nullopt);
    room.run(1.0);
    room.supervisor.onSilence(room.state.stamp + 0.2);
    EXPECT_EQ(room.supervisor.state(), FlightState::kFailsafe);
    room.state.stamp += 0.2;
    room.step();
    EXPECT_EQ(room.supervisor.state(), resume ? FlightState::kTrajectory : FlightState::kPositionHold);
    room.run(8.0);
    EXPECT_EQ(room.state.position.x() > 1.5, resume);
  }
}

TEST(Supervisor, NothingInFlightAllocates) {
  Room room;
  room.hover({0.0, 0.0, 1.0});
  RemoteControl sticks = stick(RemoteControl::Mode::kPosition);
  sticks.forward = 1.0;
  room.supervisor.onReference(line(5.0, 5.0), std::nullopt);
  room.run(0.5);
  const long before = polyfly_test::allocationCount();
  for (int k = 0; k < 100; ++k) room.supervisor.onOdometry(room.state);
  polyfly::VehicleState turned = room.state;
  turned.attitude = Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ()) * turned.attitude;
  turned.angular_velocity.z() = 1.0;
  for (int k = 0; k < 30; ++k) {
    turned.stamp += kPeriod;
    room.supervisor.onOdometry(turned);
  }
  room.state.stamp = turned.stamp + kPeriod;
  room.supervisor.holdPosition();
  room.supervisor.onOdometry(room.state);
  room.supervisor.onRemoteControl(sticks, room.state.stamp);
  room.supervisor.onOdometry(room.state);
  room.supervisor.onTime(room.state.stamp + 5.0);
  room.supervisor.land();
  for (int k = 0; k < 20; ++k) room.supervisor.onSilence(room.state.stamp + 1.0);
  room.supervisor.onOdometry(room.state);
  sticks.mode = RemoteControl::Mode::kManual;
  room.supervisor.onRemoteControl(sticks, room.state.stamp);
  room.supervisor.onOdometry(room.state);
  EXPECT_EQ(polyfly_test::allocationCount(), before);
}

TEST(FlightOptions, ValuesOutOfRangeAreNamed) {
  polyfly::FlightOptions options;
  options.landing_speed = kNan;
  try {
    const Room room(options);
    FAIL() << "no error";
  } catch (const polyfly::Error& error) {
    EXPECT_EQ(std::string(error.what()).rfind("control_interface/landing_speed: must lie in [", 0), 0U);
  }
}

}  // namespace
