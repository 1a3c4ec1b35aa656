#include "synthetic_flight.hpp"

#include <unistd.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "mpc_core/mpc_problem.hpp"
#include "online_controller/laws/law_switch.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly {
namespace {

// Least slack of the program's constraints in the corners of the box.
constexpr double kBoundSlack = 1e-3;

const char* const kTilted = R"(
polyfly_problem: 1
name: made_AXIS
type: tracking_mpc
description: made by hand
model:
  states:
    - {name: p, unit: m}
    - {name: v, unit: m/s}
    - {name: ANGLE, unit: rad}
  inputs:
    - {name: COMMAND, unit: rad, range: [-100, 100]}
  disturbances:
    - {name: d, unit: m/s^2}
  A:
    - [0, 1, 0]
    - [0, -0.01, PULL]
    - [0, 0, -4]
  B: [[0], [0], [3.6]]
  B_d: [[0], [1], [0]]
  C: [[1, 0, 0]]
sampling_time: 0.1
horizon: 5
weights: {Q: [40, 20, 20], R: [35], R_delta: [0.3], terminal: riccati}
parameters:
  - {name: e_p_LETTER, role: error, of: p, unit: m, range: [-0.5, 0.5]}
  - {name: e_v_LETTER, role: error, of: v, unit: m/s, range: [-1, 1]}
  - {name: e_ANGLE, role: error, of: ANGLE, unit: rad, range: [-0.6, 0.6]}
  - {name: COMMAND_prev, role: previous_input, of: COMMAND, unit: rad, range: [-3, 3]}
  - {name: COMMAND_ref, role: input_reference, of: COMMAND, unit: rad, range: [-0.3, 0.3]}
)";

const char* const kVertical = R"(
polyfly_problem: 1
name: made_vertical
type: tracking_mpc
description: made by hand
model:
  states:
    - {name: p, unit: m}
    - {name: v, unit: m/s}
  inputs:
    - {name: T_cmd, unit: m/s^2, range: [-100, 100]}
  disturbances:
    - {name: d, unit: m/s^2}
  A: [[0, 1], [0, 0]]
  B: [[0], [1]]
  B_d: [[0], [1]]
  C: [[1, 0]]
sampling_time: 0.1
horizon: 5
weights: {Q: [60, 25], R: [2], R_delta: [0.0025], terminal: riccati}
parameters:
  - {name: e_p_z, role: error, of: p, unit: m, range: [-0.5, 0.5]}
  - {name: e_v_z, role: error, of: v, unit: m/s, range: [-1, 1]}
  - {name: T_cmd_prev, role: previous_input, of: T_cmd, unit: m/s^2, range: [-3, 3]}
  - {name: T_cmd_ref, role: input_reference, of: T_cmd, unit: m/s^2, range: [-3, 3]}
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t place = text.find(from); place != std::string::npos;
       place = text.find(from, place + to.size())) {
    text.replace(place, from.size(), to);
  }
  return text;
}

std::string problemText(std::size_t axis) {
  if (axis == 2) return kVertical;
  const bool longitudinal = axis == 0;
  std::string text = replaced(kTilted, "AXIS", longitudinal ? "longitudinal" : "lateral");
  text = replaced(text, "ANGLE", longitudinal ? "theta" : "phi");
  text = replaced(text, "COMMAND", longitudinal ? "theta_cmd" : "phi_cmd");
  text = replaced(text, "LETTER", longitudinal ? "x" : "y");
  return replaced(text, "PULL", longitudinal ? "9.8066" : "-9.8066");
}

// The constraints are affine in theta along the law, so the corners of the box speak for all of it.
void requireNoBound(const ParametricProgram& program, const Eigen::MatrixXd& Z, const Eigen::VectorXd& z) {
  const int count = program.parameterCount();
  for (int corner = 0; corner < 1 << count; ++corner) {
    Eigen::VectorXd theta(count);
    for (int index = 0; index < count; ++index) {
      const Signal& signal = program.parameters[static_cast<std::size_t>(index)];
      theta[index] = (corner >> index & 1) != 0 ? signal.upper : signal.lower;
    }
    const Eigen::VectorXd slack = program.b + program.S * theta - program.A * (Z * theta + z);
    if (slack.minCoeff() < kBoundSlack)
      throw std::logic_error("the hand-made map's bounds are not wide enough");
  }
}

std::array<RegionMap, 3> openAll(const ScratchFolder& folder) {
  const auto open = [&folder](std::size_t axis) {
    const std::string path = folder / ("made_" + std::to_string(axis) + ".map");
    writeMap(handMadeMap(axis), path);
    return RegionMap::open(path);
  };
  return {open(0), open(1), open(2)};
}

}  // namespace

ScratchFolder::ScratchFolder() {
  std::string pattern = std::filesystem::temp_directory_path() / "polyfly_XXXXXX";
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

MapContent handMadeMap(std::size_t axis) {
  MapContent content;
  content.problem_text = problemText(axis);
  content.problem_kind = "yaml";
  const ParametricProgram program = condense(parseProblem(content.problem_text, "made by hand"));
  const Eigen::LDLT<Eigen::MatrixXd> factor(program.H);
  const Eigen::MatrixXd Z = -factor.solve(program.F);
  const Eigen::VectorXd z = -factor.solve(program.f);
  requireNoBound(program, Z, z);
  const Eigen::RowVectorXd K = program.E.row(0) * Z + program.C.row(0);
  const double k = program.E.row(0).dot(z) + program.c(0);

  content.name = program.name;
  content.solver_status = "complete";
  content.period = program.period;
  content.tolerance = 1e-9;
  content.parameters = program.parameters;
  content.inputs = program.inputs;
  const double half_range = 0.5 * (program.parameters[0].upper - program.parameters[0].lower);
  content.planes.assign(program.parameters.size() + 1, 0.0);
  content.planes[0] = 1.0 / half_range;  // e_p <= 0
  content.laws.assign(K.data(), K.data() + K.size());
  content.laws.push_back(k);
  content.rows = {1, -1};
  MapContent::Region below;
  below.row_count = 1;
  MapContent::Region above = below;
  above.first_row = 1;
  content.regions = {below, above};
  content.candidates = {0, 1};
  content.leaves = {{0, 1}, {1, 1}};
  content.nodes = {{0, MapContent::kLeaf | 0u, MapContent::kLeaf | 1u}};
  return content;
}

HandMadeMaps::HandMadeMaps(const ScratchFolder& folder) : maps_(openAll(folder)) {}

Eigen::Vector3d SyntheticFlight::error(std::size_t sample) {
  if (sample >= kSamples / 2) return restingError();
  const double phase = 0.02 * static_cast<double>(sample);
  return {0.1 * std::sin(phase), 0.05 * std::cos(phase), -0.03 * std::sin(2.0 * phase)};
}

VehicleState SyntheticFlight::state(std::size_t sample, const Eigen::Vector3d& moved) {
  VehicleState state;
  state.stamp = kStart + kPeriod * static_cast<double>(sample);
  state.position = home() + error(sample) + moved;
  return state;
}

struct FlightRecorder::Node {
  LawSwitch law;
  Reference reference;
  bool has_reference = false;
};

FlightRecorder::FlightRecorder(const AxisMaps& maps, const MultirotorOptions& options)
    : node_(new Node{LawSwitch(std::make_unique<MultirotorController>(maps, options), options), Reference{},
                     false}) {
  log_.source = "synthetic flight";
}

FlightRecorder::~FlightRecorder() { delete node_; }

void FlightRecorder::hold(const Eigen::Vector3d& position) {
  node_->reference = Reference{};
  node_->reference.position = position;
  node_->has_reference = true;
  log_.add(ReferenceTrajectory::pose(position, 0.0), std::nullopt);
}

void FlightRecorder::fly(const VehicleState& state) {
  log_.add(state);
  if (node_->has_reference) {
    node_->law.step(state, &node_->reference);
  } else {
    node_->law.stepWithoutReference(state.stamp);
  }
  record(state.stamp);
}

void FlightRecorder::miss(const VehicleState& state) { log_.add(state); }

void FlightRecorder::beSilent(double stamp) {
  log_.addSilence(stamp);
  node_->law.onSilence(stamp);
  record(stamp);
}

void FlightRecorder::record(double stamp) {
  const ControlReport& report = node_->law.report();
  FlightLog::Status status;
  status.stamp = stamp;
  status.sequence = static_cast<std::uint32_t>(log_.commands.size());
  log_.commands.push_back({stamp, report.command});
  status.status = report.status;
  status.reason = report.reason;
  status.step_time = 1e-6;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    status.region[axis] = report.axis[axis].region;
    status.input[axis] = report.axis[axis].input;
    const auto begin = report.axis[axis].theta.begin();
    status.theta[axis].assign(begin, begin + report.axis[axis].size);
  }
  log_.statuses.push_back(status);
}

FlightLog syntheticFlight(const AxisMaps& maps, const MultirotorOptions& options) {
  FlightRecorder recorder(maps, options);
  recorder.hold(SyntheticFlight::home());
  for (std::size_t sample = 0; sample < SyntheticFlight::kSamples; ++sample) {
    recorder.fly(SyntheticFlight::state(sample));
  }
  return std::move(recorder.log());
}

}  // namespace polyfly
