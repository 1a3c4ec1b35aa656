// Whole flights under the supervisor with the laws that fly: from the ground, in wind, through faults, and
// down.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "online_controller/flight/flight_supervisor.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "project_root.hpp"

namespace polyfly {
namespace {

constexpr double kMass = 1.52;       // [kg]
constexpr double kGravity = 9.8066;  // [m/s^2]
constexpr double kPeriod = 0.01;     // [s]

std::unique_ptr<ControlLaw> linearLaw(const MultirotorOptions& options) {
  const std::array<MpcProblem, 3> problems{loadProblem(problemFile("multirotor_longitudinal.yaml")),
                                           loadProblem(problemFile("multirotor_lateral.yaml")),
                                           loadProblem(problemFile("multirotor_vertical.yaml"))};
  return std::make_unique<MultirotorController>(problems, options);
}

std::unique_ptr<ControlLaw> nonlinearLaw(const MultirotorOptions& options) {
  return std::make_unique<NonlinearController>(options, NonlinearMpcOptions{});
}

/// Eq. 37 on a floor at height 0: standing, it neither slides nor leans.
struct Vehicle {
  void move(const AttitudeCommand& sent) {
    constexpr int kSteps = 10;
    on_its_way.push_back(sent);
    const AttitudeCommand command = on_its_way.front();
    on_its_way.pop_front();
    const double h = kPeriod / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      roll += h * (0.9 * command.roll - roll) / 0.25;
      pitch += h * (0.9 * command.pitch - pitch) / 0.255;
      Eigen::Vector3d acceleration = command.thrust / kMass * attitude().toRotationMatrix().col(2) + wind;
      acceleration.z() -= kGravity;
      velocity += h * acceleration;
      position += h * velocity;
      if (position.z() > 0.0) continue;
      position.z() = 0.0;
      velocity.setZero();
      roll = pitch = 0.0;
    }
    time += kPeriod;
  }

  Eigen::Quaterniond attitude() const {
    return Eigen::Quaterniond(Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                              Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()));
  }

  VehicleState measure() const {
    VehicleState state;
    state.stamp = time;
    state.position = position;
    state.velocity = velocity;
    state.attitude = attitude();
    return state;
  }

  Eigen::Vector3d position = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d wind = Eigen::Vector3d::Zero();
  double roll = 0.0, pitch = 0.0;
  double time = 20.0;
  // Commands that do not act yet, one for each period of dead time.
  std::deque<AttitudeCommand> on_its_way;
};

MultirotorOptions withDelay(int periods) {
  MultirotorOptions options;
  options.delay = periods * kPeriod;
  return options;
}

ReferenceTrajectory circle() {
  std::vector<TrajectorySample> samples;
  for (int i = 0; i <= 40; ++i) {
    TrajectorySample sample;
    sample.time = 0.2 * i;
    const double angle = 2.0 * 3.14159265358979323846 * i / 40.0;
    sample.position = {1.0 - std::cos(angle), std::sin(angle), 1.0};
    samples.push_back(sample);
  }
  return ReferenceTrajectory(std::move(samples));
}

using MakeLaw = std::unique_ptr<ControlLaw> (*)(const MultirotorOptions&);

struct Flight {
  /// Commands act `delay` periods late, which the law is told.
  Flight(MakeLaw make, const Eigen::Vector3d& wind, int delay = 0)
      : law(make(withDelay(delay)), withDelay(delay)), supervisor(law, withDelay(delay), FlightOptions{}) {
    vehicle.wind = wind;
    vehicle.on_its_way.assign(static_cast<std::size_t>(delay), {0.0, 0.0, 0.0, kMass * kGravity});
  }

  void run(double seconds) {
    for (int k = 0; k < std::lround(seconds / kPeriod); ++k) {
      const AttitudeCommand command = supervisor.onOdometry(vehicle.measure()).command;
      law.prepare();
      EXPECT_LE(std::abs(command.roll), 0.4363323);
      EXPECT_LE(std::abs(command.pitch), 0.4363323);
      EXPECT_LE(command.thrust, 20.0 * kMass);
      vehicle.move(command);
    }
  }

  LawSwitch law;
  FlightSupervisor supervisor;
  Vehicle vehicle;
};

class WholeFlight : public testing::TestWithParam<MakeLaw> {};

TEST_P(WholeFlight, FromTheGroundAndBackInWind) {
  struct Case {
    Eigen::Vector3d wind;
    int delay;
  };
  for (const Case& one : {Case{{0.0, 0.0, 0.0}, 0}, Case{{1.2, -0.8, -0.6}, 0}, Case{{1.2, -0.8, -0.6}, 6}}) {
    Flight flight(GetParam(), one.wind, one.delay);
    flight.run(0.1);
    flight.vehicle.position.setZero();  // hover thrust may have lifted it
    flight.vehicle.velocity.setZero();
    flight.run(0.01);
    ASSERT_EQ(flight.supervisor.takeOff(), nullptr);
    flight.run(8.0);
    EXPECT_EQ(flight.supervisor.state(), FlightState::kPositionHold);
    EXPECT_LT((flight.vehicle.position - Eigen::Vector3d(0.0, 0.0, 1.0)).norm(), 0.1);
    ASSERT_EQ(flight.supervisor.onReference(circle(), std::nullopt), nullptr);
    flight.run(4.0);
    EXPECT_EQ(flight.supervisor.state(), FlightState::kTrajectory);
    EXPECT_LT((flight.vehicle.position - Eigen::Vector3d(2.0, 0.0, 1.0)).norm(), 0.15);
    flight.run(4.5);
    EXPECT_EQ(flight.supervisor.state(), FlightState::kPositionHold);
    ASSERT_EQ(flight.supervisor.land(), nullptr);
    flight.run(6.0);
    EXPECT_EQ(flight.supervisor.state(), FlightState::kLanded);
    EXPECT_LT(flight.vehicle.position.head<2>().norm(), 0.3);
    EXPECT_EQ(flight.supervisor.report().command.thrust, 0.0);
  }
}

/// Faults in a hover, with a command that acts `delay` periods late.
void surviveFaults(MakeLaw make, int delay) {
  Flight flight(make, {0.8, 0.3, 0.0}, delay);
  flight.vehicle.position.z() = 1.0;
  flight.run(0.02);
  flight.supervisor.onReference(ReferenceTrajectory::pose({0.0, 0.0, 1.0}, 0.0), std::nullopt);
  flight.run(6.0);
  for (int fault = 0; fault < 12; ++fault) {
    for (int k = 0; k < 15; ++k) {  // longer than the last command is held
      VehicleState state = flight.vehicle.measure();
      if (fault % 4 == 0) state.position.x() += 3.0 * (k % 2 == 0 ? 1.0 : -1.0);
      if (fault % 4 == 1) state.stamp -= 1.0 + k;  // further back each time
      if (fault % 4 == 2) state.velocity.y() = std::nan("");
      const ControlReport& report = fault % 4 == 3 ? flight.supervisor.onSilence(flight.vehicle.time)
                                                   : flight.supervisor.onOdometry(state);
      const AttitudeCommand command = report.command;
      flight.vehicle.move(command);
    }
    EXPECT_EQ(flight.supervisor.state(), FlightState::kFailsafe) << fault;
    flight.run(2.0);
    EXPECT_EQ(flight.supervisor.state(), FlightState::kPositionHold) << fault;
  }
  flight.run(6.0);
  EXPECT_LT((flight.vehicle.position - Eigen::Vector3d(0.0, 0.0, 1.0)).norm(), 0.02);
}

TEST_P(WholeFlight, SilenceJumpsAndNoiseInStampsAreSurvived) { surviveFaults(GetParam(), 0); }

TEST_P(WholeFlight, TheyAreSurvivedWithADeadTime) { surviveFaults(GetParam(), 6); }

// The solver's bound is reached where many inputs are at their limits at once, far from where it shall be;
// and what it has by then is no answer, because it breaks a limit of the velocity that costs more than it
// gains.
TEST_P(WholeFlight, ATrajectoryWithoutStartBeginsWithTheNextSampleInSpiteOfDeadTime) {
  Flight flight(GetParam(), Eigen::Vector3d::Zero(), 6);
  flight.run(0.1);
  const ReferenceTrajectory circular = circle();
  for (const double seconds : {0.5, 1.0}) {
    ASSERT_EQ(flight.supervisor.onReference(circle(), std::nullopt), nullptr);
    flight.run(kPeriod);
    for (const double since : {0.0, seconds}) {
      flight.run(since);
      const Eigen::Vector3d acting = circular.sample(since + 6 * kPeriod).position;
      EXPECT_LT((flight.supervisor.preview().front().position - acting).norm(), 1e-9) << since;
    }
  }
}

TEST(SolverFailure, OfTheNonlinearLawHoldsLevelsAndEndsWithTheNextAnswer) {
  NonlinearMpcOptions mpc;
  mpc.working_sets_max = 1;
  mpc.speed_max = 1.0;
  MultirotorOptions vehicle;
  LawSwitch law(std::make_unique<NonlinearController>(vehicle, mpc), MultirotorOptions{});
  vehicle.jump_distance = 0.0;
  FlightSupervisor supervisor(law, vehicle, FlightOptions{});
  VehicleState state;
  supervisor.onOdometry(state);
  supervisor.onReference(ReferenceTrajectory::pose({0.0, 0.0, 0.0}, 0.0), std::nullopt);
  const auto step = [&](double x) {
    state.stamp += kPeriod;
    state.position.x() = x;
    const ControlReport report = supervisor.onOdometry(state);
    law.prepare();
    EXPECT_TRUE(std::isfinite(report.command.thrust));
    EXPECT_LE(std::abs(report.command.pitch), 0.4363323);
    return report;
  };
  for (int k = 0; k < 20; ++k) ASSERT_EQ(step(0.0).status, ControlStatus::kOptimal);
  for (int k = 1; k <= 15; ++k) {
    const ControlReport report = step(k % 2 == 0 ? 6.0 : -6.0);  // nothing to start from
    EXPECT_EQ(report.status, k <= 10 ? ControlStatus::kHoldLast : ControlStatus::kLevel) << k;
    EXPECT_EQ(report.reason, ControlReason::kOutsidePartition);
  }
  EXPECT_EQ(supervisor.state(), FlightState::kFailsafe);
  EXPECT_EQ(supervisor.cause(), FlightEvent::kNoAnswer);
  // The observer must forget the jumps before one working set is enough again.
  int waited = 0;
  while (step(0.0).status != ControlStatus::kOptimal && waited < 300) ++waited;
  EXPECT_LT(waited, 300);
  EXPECT_EQ(supervisor.state(), FlightState::kPositionHold);
  EXPECT_EQ(supervisor.cause(), FlightEvent::kRecovered);
}

INSTANTIATE_TEST_SUITE_P(Laws, WholeFlight, testing::Values(linearLaw, nonlinearLaw), [](const auto& law) {
  return std::string(law.index == 0 ? "linear" : "nonlinear");
});

}  // namespace
}  // namespace polyfly
