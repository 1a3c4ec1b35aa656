// The rigid-body plant against steady states, step responses and balances that are known in closed form.
#include "polyfly_test/rigid_body_plant.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "online_controller/types/attitude.hpp"

namespace polyfly {
namespace {

constexpr double kPeriod = 0.01;  // [s]

AttitudeCommand hover(const RigidBodyOptions& options) {
  AttitudeCommand command;
  command.thrust = options.mass * options.gravity;
  return command;
}

TEST(RigidBodyPlant, HoverIsAtRest) {
  const RigidBodyOptions options;
  RigidBodyPlant plant(options, {1.0, 2.0, 3.0});
  for (int i = 0; i < 500; ++i) plant.advance(hover(options), kPeriod);
  EXPECT_NEAR((plant.position() - Eigen::Vector3d(1.0, 2.0, 3.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(plant.time(), 5.0, 1e-12);
}

// The square root of the thrust is a lag of first order, slower while it falls.
TEST(RigidBodyPlant, RotorsRiseFasterThanTheyFall) {
  const RigidBodyOptions options;
  for (const double share : {1.5, 0.5}) {
    RigidBodyPlant plant(options, Eigen::Vector3d::Zero());
    AttitudeCommand command = hover(options);
    const double before = std::sqrt(command.thrust), after = std::sqrt(share * command.thrust);
    command.thrust *= share;
    const double lag = share > 1.0 ? options.rotor_up : options.rotor_down;
    for (int i = 1; i <= 10; ++i) {
      plant.advance(command, kPeriod);
      const double speed = after + (before - after) * std::exp(-i * kPeriod / lag);
      EXPECT_NEAR(plant.thrust(), speed * speed, 2e-3) << share << ", " << i;
    }
  }
}

// With rotors that follow at once the loop is angle'' = stiffness (command - angle) - damping angle'.
TEST(RigidBodyPlant, TheAttitudeLoopIsOfSecondOrderAndReachesTheCommand) {
  constexpr double kCommand = 0.05;
  RigidBodyOptions options;
  options.rotor_up = options.rotor_down = 0.001;
  const double decay = 0.5 * options.damping;
  const double frequency = std::sqrt(options.stiffness - decay * decay);
  for (const bool roll : {true, false}) {
    RigidBodyPlant plant(options, Eigen::Vector3d::Zero());
    AttitudeCommand command = hover(options);
    (roll ? command.roll : command.pitch) = kCommand;
    for (int i = 1; i <= 300; ++i) {
      plant.advance(command, kPeriod);
      const double t = i * kPeriod;
      const double left =
          std::exp(-decay * t) * (std::cos(frequency * t) + decay / frequency * std::sin(frequency * t));
      const EulerAngles angles = eulerAngles(plant.truth().attitude);
      EXPECT_NEAR(roll ? angles.roll : angles.pitch, kCommand * (1.0 - left), 0.02 * kCommand) << t;
    }
    const EulerAngles angles = eulerAngles(plant.truth().attitude);
    EXPECT_NEAR(roll ? angles.roll : angles.pitch, kCommand, 1e-6);
  }
}

// Thrust m g cos(pitch) balances gravity together with the drag, whose part in the body's plane is g sin(pitch).
TEST(RigidBodyPlant, DragLimitsTheSpeedOfATiltedFlight) {
  constexpr double kTilt = 0.2;
  const RigidBodyOptions options;
  RigidBodyPlant plant(options, Eigen::Vector3d::Zero());
  AttitudeCommand command = hover(options);
  command.pitch = kTilt;
  command.thrust *= std::cos(kTilt);
  for (int i = 0; i < 10000; ++i) plant.advance(command, kPeriod);
  const VehicleState end = plant.truth();
  const double forward = (end.attitude.conjugate() * end.velocity).x();
  EXPECT_NEAR(forward, options.gravity * std::sin(kTilt) / options.drag, 1e-3);
}

TEST(RigidBodyPlant, TheEnergyIsTheWorkOfTheThrust) {
  RigidBodyOptions options;
  options.drag = 0.0;
  RigidBodyPlant plant(options, Eigen::Vector3d::Zero());
  AttitudeCommand command = hover(options);
  double work = 0.0;
  for (int i = 0; i < 4000; ++i) {
    command.thrust = options.mass * options.gravity * (i < 2000 ? 1.3 : 0.8);
    const double before = plant.thrust() * plant.truth().velocity.z();
    plant.advance(command, RigidBodyPlant::kStep);
    work += 0.5 * RigidBodyPlant::kStep * (before + plant.thrust() * plant.truth().velocity.z());
  }
  EXPECT_GT(std::abs(work), 10.0);
  EXPECT_NEAR(plant.energy(), work, 1e-3 * std::abs(work));
}

TEST(RigidBodyPlant, MomentsAreLimited) {
  RigidBodyOptions options;
  options.moment_max = {0.2, 0.2, 0.2};
  options.rotor_up = options.rotor_down = 0.001;
  RigidBodyPlant plant(options, Eigen::Vector3d::Zero());
  AttitudeCommand command = hover(options);
  command.roll = 0.4;
  plant.advance(command, 0.05);
  const double most = 0.05 * options.moment_max.x() / options.inertia.x();
  EXPECT_LE(plant.truth().angular_velocity.x(), most);
  EXPECT_GT(plant.truth().angular_velocity.x(), 0.9 * most);
}

TEST(RigidBodyPlant, ADelayMovesTheFlightInTime) {
  RigidBodyOptions options;
  RigidBodyPlant at_once(options, Eigen::Vector3d::Zero());
  options.command_delay = 0.06;
  RigidBodyPlant later(options, Eigen::Vector3d::Zero());
  AttitudeCommand command = hover(options);
  command.roll = 0.1;
  for (int i = 0; i < 6; ++i) later.advance(command, kPeriod);
  EXPECT_EQ(later.truth().angular_velocity.x(), 0.0);
  for (int i = 0; i < 50; ++i) {
    at_once.advance(command, kPeriod);
    later.advance(command, kPeriod);
    EXPECT_NEAR(at_once.truth().angular_velocity.x(), later.truth().angular_velocity.x(), 1e-12);
  }
}

}  // namespace
}  // namespace polyfly
