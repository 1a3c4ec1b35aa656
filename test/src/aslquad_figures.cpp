#include "polyfly_test/aslquad_figures.hpp"

#include <algorithm>
#include <cmath>

#include "offline_mpt/encode.hpp"
#include "polyfly_base/yaml_field.hpp"
#include "region_maps/write_map.hpp"
#include "robust_mpc/robust_law.hpp"

namespace polyfly_test {
namespace {

using Eigen::Vector3d;
using polyfly::MpcProblem;
using polyfly::RegionMap;

// Mass of an AscTec Hummingbird with its computer [kg]. This value is chosen.
constexpr double kVehicleMass = 0.65;
// Mass of the load, as printed in the chapter [kg].
constexpr double kLoadMass = 0.16;
// Length of the string, as printed in the chapter [m].
constexpr double kStringLength = 0.65;
// Position error below which the vehicle counts as settled [m].
constexpr double kNear = 0.1;
constexpr int kNominalHorizon = 20;
constexpr std::array<const char*, 3> kAxes{"longitudinal", "lateral", "vertical"};

RegionMap solve(const polyfly::RobustProblem& problem, const std::string& path) {
  const polyfly::FeasibleSet set = polyfly::projectFeasibleSet(polyfly::buildRobustProgram(problem));
  const polyfly::RoundedLaw law =
      polyfly::roundLaw(problem, polyfly::explicitLaw(problem, set), polyfly::ExploreStatus::kComplete);
  polyfly::writeMap(polyfly::encode(law.program, law.partition), path);
  return RegionMap::open(path);
}

/// The linear MPC (Eq. 38) of the same axis, with the weights of its tie-break and no bound on states.
MpcProblem nominalProblem(const polyfly::RobustProblem& robust, const polyfly::AxisNames& names) {
  MpcProblem problem = polyfly::parseFlightModel(robust.text, robust.source);
  problem.minimum_peak = false;
  const polyfly::YamlField weights = polyfly::YamlField::parse(robust.text, robust.source).at("tie_break");
  problem.Q = weights.at("Q").weight(problem.stateCount());
  problem.R = weights.at("R").weight(1);
  problem.R_delta = Eigen::MatrixXd::Zero(1, 1);
  problem.C = Eigen::MatrixXd::Zero(1, problem.stateCount());
  problem.C(0, 0) = 1.0;
  problem.horizon = kNominalHorizon;
  polyfly::Signal input = problem.inputs[0];
  input.name = names.previous_input;
  problem.parameters.push_back({input, polyfly::ParameterRole::kPreviousInput, 0});
  input.name = names.input_reference;
  problem.parameters.push_back({input, polyfly::ParameterRole::kInputReference, 0});
  return problem;
}

}  // namespace

polyfly::PlantOptions figurePlant(AslquadFigure figure, int seed) {
  polyfly::PlantOptions plant;
  plant.seed = seed;
  plant.mass = kVehicleMass;
  plant.roll_time = plant.pitch_time = 0.2;
  plant.yaw_rate_time = 0.1;
  plant.thrust_time = 0.04;
  plant.drag = {0.15, 0.15, 0.08};
  plant.thrust_min = 3.0;
  plant.thrust_max = 25.0;
  plant.command_delay = 0.01;
  plant.position_noise = 0.001;
  plant.velocity_noise = 0.01;
  plant.attitude_noise = 0.003;
  plant.period = 0.08;
  if (figure == AslquadFigure::kHelix) {
    plant.air_velocity = {0.0, 2.0, 0.0};
    plant.turbulence_sigma = {0.5, 0.4, 0.3};
    // This length is the size of a fan.
    plant.turbulence_length = 0.6;
    return plant;
  }
  plant.gust_sigma = {0.03, 0.03, 0.02};
  plant.load.mass = kLoadMass;
  plant.load.length = kStringLength;
  plant.load.stiffness = 60.0;
  plant.load.damping = 0.4;
  plant.load.drag = 0.01;
  if (figure == AslquadFigure::kHit) {
    plant.load_hit = {1.0, 1.5, 0.0};  // 0.18 N s: 1.1 m/s of the load
    plant.load_hit_start = kHitTime;
    plant.load_hit_time = 0.1;
  }
  return plant;
}

AslquadFlights::AslquadFlights(const std::string& problems, const std::string& scratch) {
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    const std::string name = std::string("aslquad_") + kAxes[i];
    const polyfly::RobustProblem problem = polyfly::loadRobustProblem(problems + "/" + name + ".yaml");
    maps_.push_back(solve(problem, scratch + name + ".map"));
    nominal_[i] = nominalProblem(problem, polyfly::kAxisNames[i]);
    const polyfly::Signal& channel = problem.disturbances[0];
    if (i < 2) bound_[i] = std::min(-channel.lower, channel.upper);
  }
}

polyfly::MultirotorOptions AslquadFlights::options(AslquadLaw law, double mass) const {
  polyfly::MultirotorOptions options;
  options.mass = mass;
  options.control_period = samplingTime();
  // One reference for the whole horizon, as the robust law has.
  options.look_ahead = false;
  options.offset_free = law == AslquadLaw::kDisturbanceEstimate;
  options.disturbance_drift = 0.05;  // 0.08 s instead of 0.01 s between samples
  return options;
}

std::unique_ptr<polyfly::ControlLaw> AslquadFlights::make(AslquadLaw law, double mass) const {
  const polyfly::MultirotorOptions options = this->options(law, mass);
  if (law == AslquadLaw::kRobust) return std::make_unique<polyfly::MultirotorController>(maps(), options);
  std::array<MpcProblem, 3> problems = nominal_;
  // With the terminal weight of the Riccati equation, and one input that is bounded, one step is the LQR,
  // cut.
  if (law == AslquadLaw::kLqr) {
    for (MpcProblem& problem : problems) problem.horizon = 1;
  }
  return std::make_unique<polyfly::MultirotorController>(problems, options);
}

std::vector<AslquadSample> AslquadFlights::fly(AslquadFigure figure, AslquadLaw law, int seed) const {
  polyfly::PlantOptions options = figurePlant(figure, seed);
  options.period = samplingTime();
  const double carried = options.mass + options.load.mass;
  const std::unique_ptr<polyfly::ControlLaw> controller = make(law, carried);
  polyfly::PlantState start;
  start.position = figureReference(figure, 0.0).position;
  if (figure == AslquadFigure::kStep) start.position.y() -= kStepLength;
  start.thrust = options.gravity * carried / options.mass;
  polyfly::MultirotorPlant plant(options, start);
  std::vector<AslquadSample> flight;
  const double end = figureDuration(figure) - 0.5 * options.period;
  while (plant.time() < end) {
    AslquadSample sample;
    sample.time = plant.time();
    sample.reference = figureReference(figure, sample.time);
    sample.truth = plant.state();
    sample.disturbance = plant.disturbance();
    sample.measured = plant.measure();
    const polyfly::ControlReport& report = controller->step(sample.measured, &sample.reference);
    sample.command = report.command;
    sample.status = report.status;
    flight.push_back(sample);
    plant.advance(report.command);
    controller->prepare();
  }
  return flight;
}

AslquadErrors AslquadFlights::judge(AslquadFigure figure, const std::vector<AslquadSample>& flight) const {
  AslquadErrors errors;
  const double from = figure == AslquadFigure::kHelix ? kHelixJoined : 0.0;
  const double disturbed = figure == AslquadFigure::kHit ? kHitTime : 0.0;
  double squares = 0.0, changes = 0.0;
  int within = 0, counted = 0;
  for (std::size_t i = 0; i < flight.size(); ++i) {
    const AslquadSample& sample = flight[i];
    const Vector3d error = sample.truth.position - sample.reference.position;
    if (error.norm() > kNear && sample.time > disturbed)
      errors.settled = sample.time + samplingTime() - disturbed;
    errors.speed =
        std::max({errors.speed, std::abs(sample.truth.velocity.x()), std::abs(sample.truth.velocity.y())});
    errors.tilt = std::max({errors.tilt, std::abs(sample.truth.roll), std::abs(sample.truth.pitch)});
    errors.overshoot = std::max(errors.overshoot, error.y());
    errors.undershoot = std::max(errors.undershoot, -kStepLength - error.y());
    if (sample.status != polyfly::ControlStatus::kOptimal) ++errors.degraded;
    if (i > 0) {
      changes += std::pow(sample.command.roll - flight[i - 1].command.roll, 2) +
                 std::pow(sample.command.pitch - flight[i - 1].command.pitch, 2);
    }
    if (std::abs(sample.disturbance.x()) <= bound_[0] && std::abs(sample.disturbance.y()) <= bound_[1])
      ++within;
    if (sample.time < from) continue;
    ++counted;
    squares += error.squaredNorm();
    errors.greatest = std::max(errors.greatest, error.norm());
    errors.greatest_axis = errors.greatest_axis.cwiseMax(error.cwiseAbs());
  }
  errors.samples = static_cast<int>(flight.size());
  errors.rms = std::sqrt(squares / std::max(1, counted));
  errors.input_change = std::sqrt(changes / std::max(1, errors.samples - 1));
  errors.within = static_cast<double>(within) / std::max(1, errors.samples);
  return errors;
}

}  // namespace polyfly_test
