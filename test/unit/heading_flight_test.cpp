// A vehicle whose odometry has another heading than its motion: how it flies, and how with the option that tells it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "online_controller/flight/flight_supervisor.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "polyfly_test/flight_figure.hpp"
#include "polyfly_test/multirotor_plant.hpp"
#include "shipped_problems.hpp"

namespace polyfly {
namespace {

constexpr double kMisalignment = 0.35;  // [rad]

enum class LawKind { kLinear, kNonlinear };

std::unique_ptr<ControlLaw> makeLaw(LawKind kind, const MultirotorOptions& options) {
  if (kind == LawKind::kNonlinear)
    return std::make_unique<NonlinearController>(options, NonlinearMpcOptions{});
  return std::make_unique<MultirotorController>(shippedProblems(), options);
}

// What an odometry tells whose yaw is less than that of the motion.
VehicleState turnedBack(VehicleState state, double by) {
  const EulerAngles angles = eulerAngles(state.attitude);
  state.attitude = Eigen::AngleAxisd(angles.yaw - by, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(angles.pitch, Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(angles.roll, Eigen::Vector3d::UnitX());
  return state;
}

struct HeadingFlight {
  double rms = 0.0;        ///< position error [m]
  double yaw_error = 0.0;  ///< of the vehicle, at the end [rad]
};

// A figure by the flight's state machine. `misalignment` is that of the odometry; `option` is what the controller
// reckons with.
HeadingFlight fly(LawKind kind, double misalignment, double option) {
  MultirotorOptions options;
  options.heading_misalignment = option;
  const auto law = std::make_unique<LawSwitch>(makeLaw(kind, options), options);
  FlightSupervisor flight(*law, options, FlightOptions{}, PilotRule::kNotRequired);
  const FlightFigure figure{FigureOptions{}};
  PlantOptions plant_options;
  plant_options.wind = {0.5, -0.3, 0.0};
  plant_options.velocity_noise = 0.005;
  PlantState start;
  start.position = figure.at(0.0).position;
  start.thrust = plant_options.gravity;
  MultirotorPlant plant(plant_options, start);
  std::vector<TrajectorySample> samples;
  for (double time = 0.0; time <= figure.duration(); time += 0.05) {
    const Reference at = figure.at(time);
    TrajectorySample sample;
    sample.time = time;
    sample.position = at.position;
    sample.velocity = at.velocity;
    sample.acceleration = at.acceleration;
    sample.has_velocity = sample.has_acceleration = true;
    sample.yaw = at.yaw;
    sample.yaw_rate = at.yaw_rate;
    samples.push_back(sample);
  }
  HeadingFlight result;
  flight.onOdometry(turnedBack(plant.measure(), misalignment));
  EXPECT_EQ(flight.onReference(ReferenceTrajectory(samples), 0.0), nullptr);
  int count = 0;
  while (plant.time() < figure.duration()) {
    const VehicleState told = turnedBack(plant.measure(), misalignment);
    const AttitudeCommand command = flight.onOdometry(told).command;
    law->prepare();
    plant.advance(command);
    result.rms += (plant.state().position - figure.at(plant.time()).position).squaredNorm();
    ++count;
  }
  result.rms = std::sqrt(result.rms / count);
  result.yaw_error =
      std::abs(std::remainder(plant.state().yaw - figure.at(plant.time()).yaw, 2.0 * 3.14159265358979));
  return result;
}

class HeadingOfBothSigns : public testing::TestWithParam<std::pair<LawKind, double>> {};

TEST_P(HeadingOfBothSigns, TheStatedHeadingFliesAsAnAlignedOne) {
  const auto& [kind, misalignment] = GetParam();
  const HeadingFlight aligned_flight = fly(kind, 0.0, 0.0);
  const HeadingFlight without = fly(kind, misalignment, 0.0);
  const HeadingFlight with = fly(kind, misalignment, misalignment);
  EXPECT_LT(with.rms, 1.05 * aligned_flight.rms);
  EXPECT_GT(without.rms, 2.0 * aligned_flight.rms);
  EXPECT_LT(with.yaw_error, 0.05);
  EXPECT_GT(without.yaw_error, 0.9 * std::abs(misalignment));
}

INSTANTIATE_TEST_SUITE_P(Laws, HeadingOfBothSigns,
                         testing::Values(std::pair{LawKind::kLinear, kMisalignment},
                                         std::pair{LawKind::kNonlinear, -kMisalignment}));

// What is not in the world's frame of the attitude stays.
TEST(Aligned, TurnsTheAttitudeAloneAboutTheVertical) {
  VehicleState state;
  state.position = {1.0, 2.0, 3.0};
  state.velocity = {4.0, 5.0, 6.0};
  state.angular_velocity = {7.0, 8.0, 9.0};
  state.attitude = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY());
  const VehicleState turned = aligned(state, 0.5);
  EXPECT_EQ(turned.position, state.position);
  EXPECT_EQ(turned.velocity, state.velocity);
  EXPECT_EQ(turned.angular_velocity, state.angular_velocity);
  const EulerAngles angles = eulerAngles(turned.attitude);
  EXPECT_NEAR(angles.yaw, 0.5, 1e-12);
  EXPECT_NEAR(angles.pitch, 0.3, 1e-12);
  EXPECT_NEAR(angles.roll, 0.0, 1e-12);
  EXPECT_EQ(aligned(state, 0.0).attitude.coeffs(), state.attitude.coeffs());
}

}  // namespace
}  // namespace polyfly
