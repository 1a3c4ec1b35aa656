// What must hold whatever comes in: finite commands, no allocation, the same bits for the same calls.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <random>
#include <vector>

#include "allocations.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/reference/reference_schedule.hpp"
#include "online_support.hpp"

namespace {

using polyfly::AttitudeCommand;
using polyfly::ControlReason;
using polyfly::ControlReport;
using polyfly::ControlStatus;
using polyfly::Reference;
using polyfly::VehicleState;
using polyfly_test::Flight;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool safe(const AttitudeCommand& command) {
  const polyfly::MultirotorOptions options;
  return std::abs(command.roll) <= options.angle_max && std::abs(command.pitch) <= options.angle_max &&
         std::abs(command.yaw_rate) <= options.yaw_rate_max &&
         command.thrust >= options.mass * options.thrust_min &&
         command.thrust <= options.mass * options.thrust_max;
}

/// The vehicle on a slow circle, `k` periods after the start.
VehicleState stateAt(int k) {
  const double t = 0.01 * k;
  VehicleState state;
  state.stamp = 100.0 + t;
  state.position = {std::sin(t), std::cos(t), 1.0 + 0.1 * t};
  state.velocity = {std::cos(t), -std::sin(t), 0.1};
  state.attitude = Eigen::Quaterniond(Eigen::AngleAxisd(0.1 * std::sin(t), Eigen::Vector3d::UnitY()));
  return state;
}

Reference referenceAt(int k) {
  const double t = 0.01 * k;
  Reference reference;
  reference.position = {std::sin(t) + 0.1, std::cos(t), 1.0 + 0.1 * t};
  reference.velocity = {std::cos(t), -std::sin(t), 0.1};
  reference.acceleration = {-std::sin(t), -std::cos(t), 0.0};
  reference.yaw = t;
  return reference;
}

std::vector<double*> numbersOf(VehicleState& state) {
  return {&state.stamp,        &state.position.x(), &state.position.y(), &state.position.z(),
          &state.velocity.x(), &state.velocity.y(), &state.velocity.z(), &state.attitude.w(),
          &state.attitude.x(), &state.attitude.y(), &state.attitude.z()};
}

std::array<double, 4> numbersOf(const AttitudeCommand& command) {
  return {command.roll, command.pitch, command.yaw_rate, command.thrust};
}

std::vector<double*> numbersOf(Reference& reference) {
  return {&reference.position.x(), &reference.position.y(), &reference.position.z(),
          &reference.velocity.x(), &reference.velocity.z(), &reference.acceleration.x(),
          &reference.jerk.y(),     &reference.yaw,          &reference.yaw_rate};
}

TEST(Robustness, ABadNumberAnywhereHoldsAndLeavesNoTrace) {
  // Each bad sample, then good ones: the flight must go on as if the sample had been lost.
  for (const double bad : {kNan, kInfinity, -kInfinity, 1e300, -1e7}) {
    VehicleState probe;
    const std::size_t count = numbersOf(probe).size();
    for (std::size_t which = 0; which < count; ++which) {
      // A stamp that is merely large is a time like any other.
      if (which == 0 && std::isfinite(bad)) continue;
      Flight hit;
      Flight lost;
      for (int k = 0; k < 50; ++k) {
        hit.controller->step(stateAt(k), referenceAt(k));
        lost.controller->step(stateAt(k), referenceAt(k));
      }
      const AttitudeCommand last = hit.controller->report().command;
      VehicleState state = stateAt(50);
      *numbersOf(state)[which] = bad;
      const ControlReport& report = hit.controller->step(state, referenceAt(50));
      EXPECT_EQ(report.status, ControlStatus::kHoldLast) << which;
      EXPECT_EQ(report.reason, ControlReason::kNotFinite) << which;
      EXPECT_TRUE(std::isfinite(report.stamp));
      EXPECT_EQ(report.axis[0].size, 0);
      EXPECT_EQ(numbersOf(report.command), numbersOf(last)) << which;
      for (int k = 51; k < 60; ++k) {
        hit.controller->step(stateAt(k), referenceAt(k));
        lost.controller->step(stateAt(k), referenceAt(k));
        EXPECT_EQ(hit.controller->report().status, ControlStatus::kOptimal);
        EXPECT_EQ(numbersOf(hit.controller->report().command), numbersOf(lost.controller->report().command))
            << which << " at " << k;
      }
    }
  }
}

TEST(Robustness, ABadReferenceHolds) {
  Reference probe;
  const std::size_t count = numbersOf(probe).size();
  for (std::size_t which = 0; which < count; ++which) {
    Flight flight;
    for (int k = 0; k < 10; ++k) flight.controller->step(stateAt(k), referenceAt(k));
    Reference reference = referenceAt(10);
    *numbersOf(reference)[which] = kNan;
    const ControlReport& report = flight.controller->step(stateAt(10), reference);
    EXPECT_EQ(report.status, ControlStatus::kHoldLast) << which;
    EXPECT_EQ(report.reason, ControlReason::kNotFinite) << which;
    EXPECT_TRUE(safe(report.command));
    EXPECT_EQ(flight.controller->step(stateAt(11), referenceAt(11)).status, ControlStatus::kOptimal);
  }
}

TEST(Robustness, AQuaternionThatIsNoneIsRefused) {
  Flight flight;
  VehicleState state = stateAt(0);
  state.attitude = Eigen::Quaterniond(0.0, 0.0, 0.0, 0.0);
  EXPECT_EQ(flight.controller->step(state, referenceAt(0)).reason, ControlReason::kNotFinite);
  state.attitude = Eigen::Quaterniond(2.0, 0.0, 0.0, 0.0);
  EXPECT_EQ(flight.controller->step(state, referenceAt(0)).reason, ControlReason::kNotFinite);
}

TEST(Robustness, AnyInputGivesASafeCommand) {
  std::mt19937_64 random(5);
  std::uniform_int_distribution<int> choice(0, 9);
  std::normal_distribution<double> normal;
  const auto number = [&]() -> double {
    switch (choice(random)) {
      case 0:
        return kNan;
      case 1:
        return 1e6 * normal(random);
      case 2:
        return 0.0;
      default:
        return 3.0 * normal(random);
    }
  };
  Flight flight;
  for (int k = 0; k < 20000; ++k) {
    VehicleState state = stateAt(k % 500);
    Reference reference = referenceAt(k % 500);
    if (choice(random) < 5) {
      state.attitude =
          Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
      state.position = {number(), number(), number()};
      reference.velocity = {number(), number(), number()};
      reference.jerk = {number(), number(), number()};
      reference.yaw = number();
    }
    const ControlReport& report = flight.controller->step(state, reference);
    ASSERT_TRUE(safe(report.command)) << k;
    for (const polyfly::AxisReport& axis : report.axis) {
      ASSERT_TRUE(std::isfinite(axis.disturbance)) << k;
      ASSERT_TRUE(std::isfinite(axis.input)) << k;
    }
  }
}

TEST(Robustness, LostSamplesAreCountedFromTheStamps) {
  // Climbing steadily with the reference, all explained by the model without disturbance, with five samples
  // lost.
  const auto climbing = [](int k) {
    VehicleState state;
    state.stamp = 0.01 * k;
    state.position.z() = 0.02 * k;
    state.velocity.z() = 2.0;
    return state;
  };
  const auto disturbance_after = [&](int stamp_of_last) {
    Flight flight;
    for (int k = 0; k <= 20; ++k) {
      VehicleState state = climbing(k < 20 ? k : 25);
      if (k == 20) state.stamp = 0.01 * stamp_of_last;
      Reference reference;
      reference.position = state.position;
      reference.velocity = state.velocity;
      flight.controller->step(state, reference);
    }
    return flight.controller->report().axis[2].disturbance;
  };
  EXPECT_NEAR(disturbance_after(25), 0.0, 1e-9);
  // The same movement in one period would not be explained.
  EXPECT_GT(std::abs(disturbance_after(20)), 1e-3);
}

TEST(Robustness, ARepeatedStampDoesNotMoveTheObserver) {
  Flight flight;
  for (int k = 0; k < 20; ++k) flight.controller->step(stateAt(k), referenceAt(k));
  const double disturbance = flight.controller->report().axis[0].disturbance;
  flight.controller->step(stateAt(19), referenceAt(19));
  EXPECT_EQ(flight.controller->report().axis[0].disturbance, disturbance);
}

TEST(Robustness, TimeGoingBackStartsAnotherFlight) {
  Flight flight;
  for (int k = 1000; k < 1100; ++k) flight.controller->step(stateAt(k), referenceAt(k));
  EXPECT_NE(flight.controller->report().axis[0].disturbance, 0.0);
  flight.controller->step(stateAt(0), referenceAt(0));
  EXPECT_EQ(flight.controller->report().axis[0].disturbance, 0.0);
}

/// A flight with every kind of event, its reports as bytes.
std::vector<double> eventfulFlight(Flight& flight) {
  std::vector<double> numbers;
  const auto note = [&](const ControlReport& report) {
    numbers.insert(numbers.end(), {report.command.roll, report.command.pitch, report.command.yaw_rate,
                                   report.command.thrust, static_cast<double>(report.status)});
    for (const polyfly::AxisReport& axis : report.axis) {
      numbers.insert(numbers.end(), axis.theta.begin(), axis.theta.end());
      numbers.insert(numbers.end(), {axis.input, axis.disturbance, static_cast<double>(axis.region)});
    }
  };
  note(flight.controller->stepWithoutReference(99.0));
  for (int k = 0; k < 400; ++k) {
    VehicleState state = stateAt(k);
    if (k % 50 == 20) state.velocity.y() = kNan;
    if (k % 50 == 30) state.position.x() += 20.0;
    if (k % 100 == 70) note(flight.controller->onSilence(state.stamp));
    note(flight.controller->step(state, referenceAt(k)));
  }
  return numbers;
}

TEST(Robustness, TheSameCallsGiveTheSameBits) {
  Flight one;
  Flight two;
  const std::vector<double> first = eventfulFlight(one);
  const std::vector<double> second = eventfulFlight(two);
  one.controller->reset();
  const std::vector<double> again = eventfulFlight(one);
  ASSERT_EQ(first.size(), second.size());
  EXPECT_EQ(std::memcmp(first.data(), second.data(), first.size() * sizeof(double)), 0);
  EXPECT_EQ(std::memcmp(first.data(), again.data(), first.size() * sizeof(double)), 0);
}

TEST(Robustness, TheCounterCounts) {
  const long before = polyfly_test::allocationCount();
  ::operator delete(::operator new(100));  // called directly, which no compiler leaves out
  EXPECT_GT(polyfly_test::allocationCount(), before);
}

TEST(Robustness, NoCallInFlightAllocates) {
  Flight flight;
  polyfly::ReferenceSchedule schedule;
  std::vector<polyfly::TrajectorySample> samples(100);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].time = 0.1 * static_cast<double>(i);
  schedule.set(polyfly::ReferenceTrajectory(samples), 100.0);
  schedule.set(polyfly::ReferenceTrajectory(samples), 102.0);
  VehicleState bad = stateAt(3);
  bad.attitude.w() = kNan;
  VehicleState far = stateAt(4);
  far.position.x() = 50.0;

  const long before = polyfly_test::allocationCount();
  flight.controller->stepWithoutReference(99.0);
  for (int k = 0; k < 300; ++k) {
    const std::optional<Reference> reference = schedule.sample(stateAt(k).stamp);
    flight.controller->step(stateAt(k), *reference);
    flight.controller->step(stateAt(k), referenceAt(k));
  }
  for (int k = 0; k < 20; ++k) flight.controller->step(bad, referenceAt(k));
  flight.controller->step(far, referenceAt(4));
  flight.controller->onSilence(200.0);
  flight.controller->reset();
  EXPECT_EQ(polyfly_test::allocationCount(), before);
}

}  // namespace
