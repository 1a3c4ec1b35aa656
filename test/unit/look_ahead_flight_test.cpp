// What the law linear gains from the references ahead: flights that online_controller/README.md tabulates.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "polyfly_test/multirotor_plant.hpp"
#include "project_root.hpp"

namespace polyfly {
namespace {

using Path = std::function<Reference(double)>;

/// Root mean square of the position error along the path for so long [m].
double fly(const Path& path, double seconds, bool look_ahead) {
  MultirotorOptions options;
  options.look_ahead = look_ahead;
  MultirotorController law({loadProblem(problemFile("multirotor_longitudinal.yaml")),
                            loadProblem(problemFile("multirotor_lateral.yaml")),
                            loadProblem(problemFile("multirotor_vertical.yaml"))},
                           options);
  PlantState state;
  state.position = path(0.0).position;
  state.thrust = PlantOptions{}.gravity;
  MultirotorPlant plant(PlantOptions{}, state);
  std::vector<Reference> preview(static_cast<std::size_t>(law.previewLength()));
  double sum = 0.0;
  int samples = 0;
  for (; plant.time() < seconds; ++samples) {
    const VehicleState measured = plant.measure();
    for (std::size_t k = 0; k < preview.size(); ++k)
      preview[k] = path(measured.stamp + static_cast<double>(k) * law.previewPeriod());
    const ControlReport& report = law.step(measured, preview.data());
    EXPECT_EQ(report.status, ControlStatus::kOptimal);
    plant.advance(report.command);
    sum += (plant.state().position - path(plant.time()).position).squaredNorm();
  }
  return std::sqrt(sum / samples);
}

void expectGain(const std::string& name, const Path& path, double seconds, double factor) {
  const double one = fly(path, seconds, false), ahead = fly(path, seconds, true);
  testing::Test::RecordProperty(name + "_one_reference", std::to_string(one));
  testing::Test::RecordProperty(name + "_look_ahead", std::to_string(ahead));
  EXPECT_LT(factor * ahead, one) << name << ": " << one << " and " << ahead;
}

/// From rest at 2 s on, 6 m along x and 6 m along y at 1.5 m/s, with or without the velocity.
Path corner(bool with_velocity) {
  return [=](double time) {
    constexpr double kSpeed = 1.5, kLeg = 6.0;
    const double way = kSpeed * std::max(0.0, time - 2.0);
    Reference reference;
    reference.position = {std::min(way, kLeg), std::clamp(way - kLeg, 0.0, kLeg), 1.0};
    if (with_velocity && way > 0.0 && way < kLeg) reference.velocity.x() = kSpeed;
    if (with_velocity && way >= kLeg && way < 2.0 * kLeg) reference.velocity.y() = kSpeed;
    return reference;
  };
}

TEST(LookAheadFlight, Corners) { expectGain("corners", corner(true), 14.0, 5.0); }

TEST(LookAheadFlight, WayPointsWithoutFeedForward) {
  expectGain("corners_without_velocity", corner(false), 14.0, 3.0);
  const auto steps = [](double time) {
    Reference reference;
    reference.position = {std::floor(time / 2.0), 0.0, 1.0};
    return reference;
  };
  expectGain("way_points", steps, 16.0, 2.0);
}

TEST(LookAheadFlight, AStop) {
  const auto stop = [](double time) {
    constexpr double kSpeed = 3.0;
    Reference reference;
    reference.position = {kSpeed * std::clamp(time - 1.0, 0.0, 3.0), 0.0, 1.0};
    if (time >= 1.0 && time < 4.0) reference.velocity.x() = kSpeed;
    return reference;
  };
  expectGain("stop", stop, 10.0, 8.0);
}

}  // namespace
}  // namespace polyfly
