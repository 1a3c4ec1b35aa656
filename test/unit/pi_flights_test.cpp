// The laws beside a PI controller on the rigid-body plant: with the shipped models, and with the vehicle's own.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "identification/identify_axis.hpp"
#include "identification/motion.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "online_controller/types/attitude.hpp"
#include "polyfly_test/flight_figure.hpp"
#include "polyfly_test/multirotor_plant.hpp"
#include "polyfly_test/pi_controller.hpp"
#include "polyfly_test/rigid_body_plant.hpp"
#include "project_root.hpp"

namespace polyfly {
namespace {

constexpr double kPeriod = 0.01;  // [s]

using Path = std::function<Reference(double)>;
using Pilot = std::function<AttitudeCommand(const VehicleState&, const Path&)>;

/// A circle with a climb, from rest to `speed` within 5 s.
Path helix(double radius, double speed, double climb) {
  return [=](double time) {
    constexpr double kRamp = 5.0;
    const double x = std::min(time / kRamp, 1.0);
    const double phase = kRamp * x * x * x * x * (2.5 - 3.0 * x + x * x) + std::max(0.0, time - kRamp);
    const double rate = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
    const double acceleration = 30.0 * x * x * (1.0 - x) * (1.0 - x) / kRamp;
    const double jerk = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (kRamp * kRamp);
    const double k = speed / radius;
    const double w = k * rate, a = k * acceleration, j = k * jerk;
    const Eigen::Vector3d out(std::cos(k * phase), std::sin(k * phase), 0.0);
    const Eigen::Vector3d along(-out.y(), out.x(), 0.0);
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    Reference reference;
    reference.position = radius * out + (1.0 + climb * phase) * up;
    reference.velocity = radius * w * along + climb * rate * up;
    reference.acceleration = radius * (a * along - w * w * out) + climb * acceleration * up;
    reference.jerk = radius * ((j - w * w * w) * along - 3.0 * w * a * out) + climb * jerk * up;
    return reference;
  };
}

Path slowEight() {
  FigureOptions options;
  options.rate = 0.4;
  options.yaw_turn = 0.0;
  const FlightFigure figure(options);
  return [figure](double time) { return figure.at(time); };
}

/// Root mean square of the position error [m].
double fly(const Pilot& pilot, const Path& path, const RigidBodyOptions& options) {
  RigidBodyPlant plant(options, path(0.0).position);
  double sum = 0.0;
  constexpr int kSamples = 3000;
  for (int i = 0; i < kSamples; ++i) {
    plant.advance(pilot(plant.measure(), path), kPeriod);
    sum += (plant.position() - path(plant.time()).position).squaredNorm();
  }
  return std::sqrt(sum / kSamples);
}

Pilot pilotOf(const std::shared_ptr<ControlLaw>& law) {
  return [law](const VehicleState& state, const Path& path) {
    std::vector<Reference> preview(static_cast<std::size_t>(law->previewLength()));
    for (std::size_t k = 0; k < preview.size(); ++k)
      preview[k] = path(state.stamp + static_cast<double>(k) * law->previewPeriod());
    const AttitudeCommand command = law->step(state, preview.data()).command;
    law->prepare();
    return command;
  };
}

Pilot piPilot() {
  auto pi = std::make_shared<PiController>(MultirotorOptions{});
  return [pi](const VehicleState& state, const Path& path) { return pi->step(state, path(state.stamp)); };
}

/// Numbers of Eq. 37 for roll and pitch alike.
struct Model {
  double gain, lag, drag;  // [1], [s], [1/s]
};

double valueOf(const std::vector<FittedParameter>& parameters, const std::string& name) {
  for (const FittedParameter& parameter : parameters) {
    if (parameter.name != name) continue;
    EXPECT_TRUE(parameter.supported) << name;
    return parameter.value;
  }
  ADD_FAILURE() << "no parameter " << name;
  return 0.0;
}

void record(const char* name, double time, double value, FlightSignals* log) {
  log->series[name].time.push_back(time);
  log->series[name].value.push_back(value);
}

/// What `calibrate` sees of a minute of steps to and fro by the PI controller, measured with noise.
FlightSignals flightToIdentify() {
  RigidBodyOptions options;
  options.position_noise = 0.002;
  options.velocity_noise = 0.01;
  options.attitude_noise = 0.002;
  const auto goal = [](double time) {
    Reference reference;
    reference.position = {std::fmod(time, 7.0) < 3.5 ? 4.0 : 0.0, std::fmod(time, 5.0) < 2.5 ? 3.0 : 0.0,
                          1.0};
    return reference;
  };
  RigidBodyPlant plant(options, Eigen::Vector3d::Zero());
  const Pilot pi = piPilot();
  FlightSignals log;
  log.source = "steps to and fro";
  while (plant.time() < 60.0) {
    const VehicleState state = plant.measure();
    const AttitudeCommand command = pi(state, goal);
    const EulerAngles angles = eulerAngles(state.attitude);
    record("roll_cmd", state.stamp, command.roll, &log);
    record("pitch_cmd", state.stamp, command.pitch, &log);
    record("roll", state.stamp, angles.roll, &log);
    record("pitch", state.stamp, angles.pitch, &log);
    record("yaw", state.stamp, angles.yaw, &log);
    record("vx", state.stamp, state.velocity.x(), &log);
    record("vy", state.stamp, state.velocity.y(), &log);
    record("vz", state.stamp, state.velocity.z(), &log);
    plant.advance(command, kPeriod);
  }
  return log;
}

/// What `calibrate attitude` and `calibrate drag` find for the laws; roll stands for pitch too.
Model identifiedModel() {
  const FlightSignals log = flightToIdentify();
  const AxisModel roll = identifyAxis(axisRecords(log, "roll"), {});
  const ControllerModel* model = roll.findModel("model_without_delay");
  EXPECT_TRUE(model != nullptr && model->supported());
  return {valueOf(model->fit.parameters, "gain"), valueOf(model->fit.parameters, "tau"),
          valueOf(fitDrag(motionOf(log, {})).parameters, "drag_left")};
}

MpcProblem problemWith(const char* axis, const Model* model) {
  MpcProblem problem = loadProblem(problemFile(std::string("multirotor_") + axis + ".yaml"));
  if (model == nullptr || problem.stateCount() != 3) return problem;
  problem.A_c(1, 1) = -model->drag;
  problem.A_c(2, 2) = -1.0 / model->lag;
  problem.B_c(2, 0) = model->gain / model->lag;
  return problem;
}

// The drift of the disturbance's rate that the README names for vehicles that are not calibrated [m/s^3].
constexpr double kRateDrift = 0.03;

/// Without look-ahead its commands are those of explicit_linear within 1e-6 (laws_test).
Pilot linearPilot(bool look_ahead, const Model* model, double rate_drift) {
  MultirotorOptions options;
  options.disturbance_rate_drift = rate_drift;
  options.look_ahead = look_ahead;
  return pilotOf(std::make_shared<MultirotorController>(
      std::array<MpcProblem, 3>{problemWith("longitudinal", model), problemWith("lateral", model),
                                problemWith("vertical", model)},
      options));
}

Pilot nonlinearPilot(const Model* model, double rate_drift) {
  MultirotorOptions vehicle;
  vehicle.disturbance_rate_drift = rate_drift;
  NonlinearMpcOptions options;
  if (model != nullptr) {
    options.model.roll_gain = options.model.pitch_gain = model->gain;
    options.model.roll_time = options.model.pitch_time = model->lag;
    options.model.drag.head<2>().setConstant(model->drag);
  }
  return pilotOf(std::make_shared<NonlinearController>(vehicle, options));
}

struct Case {
  const char* name;
  Path path;
  double mass_share;
};

std::vector<Case> cases() {
  return {{"circle_5", helix(8.0, 5.0, 0.0), 1.0},
          {"helix_1.5", helix(1.5, 1.5, 0.3), 1.0},
          {"slow_eight", slowEight(), 1.0},
          {"less_mass", slowEight(), 0.8}};
}

struct Row {
  double pi, linear, explicit_linear, nonlinear;  // rms [m]
};

Row flyAll(const Case& flight, const Model* model, double rate_drift = kRateDrift) {
  RigidBodyOptions plant;
  plant.mass *= flight.mass_share;
  return {fly(piPilot(), flight.path, plant), fly(linearPilot(true, model, rate_drift), flight.path, plant),
          fly(linearPilot(false, model, rate_drift), flight.path, plant),
          fly(nonlinearPilot(model, rate_drift), flight.path, plant)};
}

double worst(const Row& row) { return std::max({row.linear, row.explicit_linear, row.nonlinear}); }

void tell(const std::string& name, const Row& row) {
  const std::pair<const char*, double> laws[] = {{"pi", row.pi},
                                                 {"linear", row.linear},
                                                 {"explicit", row.explicit_linear},
                                                 {"nonlinear", row.nonlinear}};
  for (const auto& [law, rms] : laws) testing::Test::RecordProperty(name + "_" + law, std::to_string(rms));
}

TEST(PiFlights, WithTheIdentifiedModelEachLawIsCloserThanThePi) {
  const Model model = identifiedModel();
  EXPECT_NEAR(model.gain, 1.0, 0.03);
  EXPECT_NEAR(model.drag, RigidBodyOptions{}.drag, 0.03);
  for (const Case& flight : cases()) {
    const Row by_default = flyAll(flight, &model, 0.0), row = flyAll(flight, &model);
    tell(std::string(flight.name) + "_constant", by_default);
    tell(flight.name, row);
    EXPECT_LT(worst(by_default), flight.mass_share == 1.0 ? 0.5 * row.pi : row.pi) << flight.name;
    EXPECT_LT(worst(row), flight.mass_share == 1.0 ? 0.5 * row.pi : row.pi) << flight.name;
  }
}

// The models say 0.9, 0.25 s and 0.01 1/s where 1, 0.19 s and 0.17 1/s are true. What that leaves turns with the path.
// An observer that takes it for constant follows it late, and its lag through the attitude loop is not led.
TEST(PiFlights, WithTheShippedModelsEachLawIsWithinAFifthOfThePi) {
  constexpr double kWithin = 1.2;
  for (const Case& flight : cases()) {
    const Row constant = flyAll(flight, nullptr, 0.0);
    const Row row = flyAll(flight, nullptr);
    tell(std::string(flight.name) + "_constant", constant);
    tell(flight.name, row);
    EXPECT_LT(worst(row), kWithin * row.pi) << flight.name;
    EXPECT_LT(worst(row), 0.35 * worst(constant)) << flight.name;
  }
}

Path hover() {
  return [](double) {
    Reference reference;
    reference.position.z() = 1.0;
    return reference;
  };
}

/// RMS of the position error [m] in 15 s on the plant of Eq. 37, which the shipped models describe.
double flyModel(const Pilot& pilot, const Path& path, const PlantOptions& options) {
  PlantState start;
  start.position = path(0.0).position;
  start.thrust = options.gravity;
  MultirotorPlant plant(options, start);
  double sum = 0.0;
  constexpr int kSamples = 1500;
  for (int i = 0; i < kSamples; ++i) {
    plant.advance(pilot(plant.measure(), path));
    sum += (plant.truth().position - path(plant.time()).position).squaredNorm();
  }
  return std::sqrt(sum / kSamples);
}

/// Least and greatest ratio of the errors with the rate of the disturbance and without.
std::pair<double, double> ratiosOfTheRate(const Path& path, const PlantOptions& options) {
  std::vector<double> ratios;
  for (const bool look_ahead : {true, false})
    ratios.push_back(flyModel(linearPilot(look_ahead, nullptr, kRateDrift), path, options) /
                     flyModel(linearPilot(look_ahead, nullptr, 0.0), path, options));
  ratios.push_back(flyModel(nonlinearPilot(nullptr, kRateDrift), path, options) /
                   flyModel(nonlinearPilot(nullptr, 0.0), path, options));
  const auto [least, greatest] = std::minmax_element(ratios.begin(), ratios.end());
  return {*least, *greatest};
}

TEST(PiFlights, TheRateOfTheDisturbanceCostsLittleWhereTheModelIsTrue) {
  PlantOptions noise;
  noise.position_noise = 0.01;
  noise.velocity_noise = 0.05;
  noise.attitude_noise = 0.005;
  EXPECT_LT(ratiosOfTheRate(hover(), noise).second, 1.2);
  noise.gust_sigma.setConstant(0.5);
  EXPECT_LT(ratiosOfTheRate(hover(), noise).second, 0.6);
  EXPECT_LT(ratiosOfTheRate(helix(8.0, 5.0, 0.0), {}).second, 1.1);
  const Path steps = [](double time) {
    Reference reference;
    reference.position = {std::fmod(time, 10.0) < 5.0 ? 0.0 : 1.0, 0.0, 1.0};
    return reference;
  };
  const auto [least, greatest] = ratiosOfTheRate(steps, {});
  EXPECT_GT(least, 0.99);
  EXPECT_LT(greatest, 1.01);
}

}  // namespace
}  // namespace polyfly
