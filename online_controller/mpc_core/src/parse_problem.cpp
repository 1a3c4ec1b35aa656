#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "mpc_core/decompositions.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/problem_type.hpp"
#include "mpc_core/read_problem.hpp"
#include "parse_parts.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/yaml_field.hpp"

namespace polyfly {
namespace {

constexpr int kSchemaVersion = 1;
constexpr int kMaxHorizon = 200;
constexpr double kDefiniteTolerance =
    1e-12;  // least eigenvalue relative to the greatest, for R > 0 and Q >= 0

using Names = std::set<std::string>;

void removeBounds(Signal* signal) {
  signal->lower = -std::numeric_limits<double>::infinity();
  signal->upper = std::numeric_limits<double>::infinity();
}

void readStates(const YamlField& model, Names* taken, MpcProblem* problem) {
  for (const YamlField& field : model.at("states").items()) {
    field.checkKeys({"name", "unit"}, {"range"});
    Signal state = readSignal(field, taken);
    removeBounds(&state);
    if (field.has("range")) {
      field.at("range").range(&state.lower, &state.upper);
      if (state.lower >= 0.0 || state.upper <= 0.0) {
        field.at("range").fail("must hold 0, because it bounds the distance from the reference");
      }
    }
    problem->states.push_back(state);
  }
  if (problem->states.empty()) model.at("states").fail("must have at least one entry");
}

void readInputs(const YamlField& model, Names* taken, MpcProblem* problem) {
  for (const YamlField& field : model.at("inputs").items()) {
    field.checkKeys({"name", "unit", "range"}, {"change"});
    Signal input = readSignal(field, taken);
    field.at("range").range(&input.lower, &input.upper);
    Signal change{"change of " + input.name, input.unit, 0.0, 0.0};
    removeBounds(&change);
    if (field.has("change")) {
      field.at("change").range(&change.lower, &change.upper);
      if (change.lower > 0.0 || change.upper < 0.0)
        field.at("change").fail("must hold 0: u may stay as it is");
    }
    problem->inputs.push_back(input);
    problem->changes.push_back(change);
  }
  if (problem->inputs.empty()) model.at("inputs").fail("must have at least one entry");
}

void readDisturbances(const YamlField& model, Names* taken, MpcProblem* problem) {
  if (!model.has("disturbances")) return;
  for (const YamlField& field : model.at("disturbances").items()) {
    field.checkKeys({"name", "unit"}, {"range"});
    Signal disturbance = readSignal(field, taken);
    removeBounds(&disturbance);
    if (field.has("range")) field.at("range").range(&disturbance.lower, &disturbance.upper);
    problem->disturbances.push_back(disturbance);
  }
}

/// Without `outputs`, an output that is one state has its name and unit.
void readOutputs(const YamlField& model, Names* taken, MpcProblem* problem) {
  if (model.has("outputs")) {
    for (const YamlField& field : model.at("outputs").items()) {
      field.checkKeys({"name", "unit"}, {});
      problem->outputs.push_back(readSignal(field, taken));
      removeBounds(&problem->outputs.back());
    }
    if (static_cast<int>(problem->outputs.size()) != problem->inputCount())
      model.at("outputs").fail("must have as many entries as there are inputs");
    return;
  }
  for (Eigen::Index row = 0; row < problem->C.rows(); ++row) {
    Signal output;
    removeBounds(&output);
    for (Eigen::Index i = 0; i < problem->C.cols(); ++i) {
      if (problem->C.row(row) != Eigen::RowVectorXd::Unit(problem->C.cols(), i)) continue;
      output.name = problem->states[static_cast<std::size_t>(i)].name;
      output.unit = problem->states[static_cast<std::size_t>(i)].unit;
    }
    problem->outputs.push_back(output);
  }
}

void readModel(const YamlField& model, MpcProblem* problem) {
  model.checkKeys({"states", "inputs", "A", "B", "C"}, {"disturbances", "B_d", "time", "outputs", "delay"});
  if (model.has("time")) {
    const std::string time = model.at("time").text();
    if (time != "continuous" && time != "discrete")
      model.at("time").fail("must be continuous or discrete, got '" + time + "'");
    problem->discrete = time == "discrete";
  }
  problem->delay = readDelay(model);
  Names taken;
  readStates(model, &taken, problem);
  readInputs(model, &taken, problem);
  readDisturbances(model, &taken, problem);
  const int nx = static_cast<int>(problem->states.size());
  const int nu = static_cast<int>(problem->inputs.size());
  const int nd = static_cast<int>(problem->disturbances.size());
  problem->A_c = model.at("A").matrix(nx, nx);
  problem->B_c = model.at("B").matrix(nx, nu);
  problem->C = model.at("C").matrix(nu, nx);
  readOutputs(model, &taken, problem);
  problem->Bd_c = Eigen::MatrixXd::Zero(nx, nd);
  if (nd > 0) {
    problem->Bd_c = model.at("B_d").matrix(nx, nd);
  } else if (model.has("B_d")) {
    model.at("B_d").fail("must be absent when there are no disturbances");
  }
}

Eigen::MatrixXd readSemidefinite(const YamlField& field, int size) {
  Eigen::MatrixXd weight = field.weight(size);
  if (symmetricEigenvalues(weight)(0) < -kDefiniteTolerance * weight.cwiseAbs().maxCoeff()) {
    field.fail("must be positive semidefinite");
  }
  return weight;
}

void readWeights(const YamlField& weights, MpcProblem* problem) {
  weights.checkKeys({"Q", "R"}, {"R_delta", "terminal"});
  const int nx = problem->stateCount();
  const int nu = problem->inputCount();
  problem->Q = readSemidefinite(weights.at("Q"), nx);
  problem->R = weights.at("R").weight(nu);
  if (!(symmetricEigenvalues(problem->R)(0) > kDefiniteTolerance * problem->R.cwiseAbs().maxCoeff())) {
    weights.at("R").fail("must be positive definite");
  }
  problem->R_delta = Eigen::MatrixXd::Zero(nu, nu);
  if (weights.has("R_delta")) problem->R_delta = readSemidefinite(weights.at("R_delta"), nu);
  if (!weights.has("terminal")) return;
  const YamlField terminal = weights.at("terminal");
  if (terminal.isList()) {
    problem->P = readSemidefinite(terminal, nx);
  } else if (terminal.text() == "equality") {
    problem->terminal_equality = true;
  } else if (terminal.text() != "riccati") {
    terminal.fail("must be riccati, equality or a weight, got '" + terminal.text() + "'");
  }
}

/// `moves` lists the blocks over which u is held; `control_horizon` lets it change in the first stages only.
void readMoves(const YamlField& root, MpcProblem* problem) {
  if (root.has("control_horizon")) {
    const YamlField field = root.at("control_horizon");
    if (root.has("moves")) field.fail("moves say the same: only one of them may be given");
    const int length = field.integer(1, problem->horizon);
    problem->moves.assign(static_cast<std::size_t>(length), 1);
    problem->moves.back() = problem->horizon - length + 1;
  }
  if (!root.has("moves")) return;
  int sum = 0;
  for (const YamlField& field : root.at("moves").items()) {
    problem->moves.push_back(field.integer(1, problem->horizon));
    sum += problem->moves.back();
  }
  if (sum != problem->horizon) {
    root.at("moves").fail("must add up to the horizon " + std::to_string(problem->horizon) + ", not to " +
                          std::to_string(sum));
  }
}

/// Rules that hold between the fields: a steady state for every reference (Eq. 6) and a terminal weight.
void checkControllable(const YamlField& root, const MpcProblem& problem) {
  DiscreteModel model;
  try {
    model = discretise(problem, problem.sampling_time);
  } catch (const Error&) {
    root.at("model").at("A").fail("must not overflow within one sampling_time (Eq. 42)");
  }
  try {
    steadyState(model, problem.C, Eigen::VectorXd::Zero(model.Bd.cols()),
                Eigen::VectorXd::Zero(problem.C.rows()));
  } catch (const Error& error) {
    root.at("model").at("C").fail(error.what());
  }
  if (problem.P.size() > 0) return;
  try {
    solveRiccati(model.A, model.B, problem.Q, problem.R);
  } catch (const Error& error) {
    root.at("weights").failAt("terminal", error.what());
  }
}

}  // namespace

Signal readSignal(const YamlField& field, std::set<std::string>* taken) {
  Signal signal;
  signal.name = field.at("name").name();
  signal.unit = field.at("unit").unit();
  if (!taken->insert(signal.name).second) {
    field.at("name").fail("duplicate name '" + signal.name + "'");
  }
  return signal;
}

MpcProblem parseProblem(const std::string& text, const std::string& source) {
  const YamlField root = YamlField::parse(text, source);
  // First: the keys of another type are not unknown.
  if (root.has("type")) requireProblemType(text, source, "tracking_mpc");
  root.checkKeys(
      {"polyfly_problem", "name", "type", "model", "sampling_time", "horizon", "weights", "parameters"},
      {"description", "provenance", "calibration", "constraints", "moves", "control_horizon",
       "terminal_set"});
  // readProblem puts the numbers of these files in place of the key.
  if (root.has("calibration")) root.at("calibration").fail("names files: only a problem file may have it");
  root.at("polyfly_problem").integer(kSchemaVersion, kSchemaVersion);
  MpcProblem problem;
  problem.source = source;
  problem.text = text;
  problem.name = root.at("name").name();
  if (root.has("description")) problem.description = root.at("description").text();
  readModel(root.at("model"), &problem);
  problem.sampling_time = root.at("sampling_time").number();
  if (!(problem.sampling_time > 0.0)) root.at("sampling_time").fail("must be greater than 0");
  problem.horizon = root.at("horizon").integer(1, kMaxHorizon);
  readMoves(root, &problem);
  readWeights(root.at("weights"), &problem);
  readConstraints(root, &problem);
  readTerminalSet(root, &problem);
  readParameters(root.at("parameters"), &problem);
  checkNeededParameters(root, problem);
  checkControllable(root, problem);
  return problem;
}

MpcProblem loadProblem(const std::string& path) { return parseProblem(readProblem(path), path); }

}  // namespace polyfly
