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
#include "polyfly_base/error.hpp"
#include "polyfly_base/yaml_field.hpp"

namespace polyfly {
namespace {

constexpr int kSchemaVersion = 1;
constexpr int kMaxHorizon = 200;
constexpr double kDefiniteTolerance =
    1e-12;  // least eigenvalue relative to the greatest, for R > 0 and Q >= 0

using Names = std::set<std::string>;

Signal readSignal(const YamlField& field, Names* taken) {
  Signal signal;
  signal.name = field.at("name").name();
  signal.unit = field.at("unit").unit();
  if (!taken->insert(signal.name).second) {
    field.at("name").fail("duplicate name '" + signal.name + "'");
  }
  return signal;
}

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
    field.checkKeys({"name", "unit", "range"}, {});
    Signal input = readSignal(field, taken);
    field.at("range").range(&input.lower, &input.upper);
    problem->inputs.push_back(input);
  }
  if (problem->inputs.empty()) model.at("inputs").fail("must have at least one entry");
}

void readDisturbances(const YamlField& model, Names* taken, MpcProblem* problem) {
  if (!model.has("disturbances")) return;
  for (const YamlField& field : model.at("disturbances").items()) {
    field.checkKeys({"name", "unit"}, {});
    Signal disturbance = readSignal(field, taken);
    removeBounds(&disturbance);
    problem->disturbances.push_back(disturbance);
  }
}

void readModel(const YamlField& model, MpcProblem* problem) {
  model.checkKeys({"states", "inputs", "A", "B", "C"}, {"disturbances", "B_d"});
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
  if (weights.has("terminal") && weights.at("terminal").text() != "riccati") {
    weights.at("terminal").fail("must be riccati, got '" + weights.at("terminal").text() + "'");
  }
}

ParameterRole readRole(const YamlField& field) {
  const std::string role = field.text();
  if (role == "error") return ParameterRole::kError;
  if (role == "previous_input") return ParameterRole::kPreviousInput;
  if (role == "input_reference") return ParameterRole::kInputReference;
  field.fail("must be error, previous_input or input_reference, got '" + role + "'");
}

int indexOf(const std::vector<Signal>& signals, const std::string& name) {
  const auto found =
      std::find_if(signals.begin(), signals.end(), [&](const Signal& signal) { return signal.name == name; });
  return found == signals.end() ? -1 : static_cast<int>(found - signals.begin());
}

void readParameters(const YamlField& parameters, MpcProblem* problem) {
  Names taken;
  std::set<std::pair<ParameterRole, int>> targets;
  for (const YamlField& field : parameters.items()) {
    field.checkKeys({"name", "role", "of", "unit", "range"}, {});
    MpcProblem::Parameter parameter;
    parameter.signal = readSignal(field, &taken);
    parameter.role = readRole(field.at("role"));
    const bool error = parameter.role == ParameterRole::kError;
    const std::vector<Signal>& signals = error ? problem->states : problem->inputs;
    const std::string of = field.at("of").name();
    parameter.index = indexOf(signals, of);
    if (parameter.index < 0) {
      field.at("of").fail(std::string("must name ") + (error ? "a state" : "an input") + ", got '" + of +
                          "'");
    }
    if (!targets.insert({parameter.role, parameter.index}).second) {
      field.at("of").fail("another parameter has this role for '" + of + "'");
    }
    const std::string& unit = signals[static_cast<std::size_t>(parameter.index)].unit;
    if (parameter.signal.unit != unit) {
      field.at("unit").fail(std::string("must be ").append(unit).append(" as for '").append(of).append("'"));
    }
    field.at("range").range(&parameter.signal.lower, &parameter.signal.upper);
    problem->parameters.push_back(parameter);
  }
  for (int i = 0; i < problem->stateCount(); ++i) {
    if (targets.count({ParameterRole::kError, i}) == 0) {
      parameters.fail("must have one with role error of state '" +
                      problem->states[static_cast<std::size_t>(i)].name + "'");
    }
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
  try {
    solveRiccati(model.A, model.B, problem.Q, problem.R);
  } catch (const Error& error) {
    root.at("weights").failAt("terminal", error.what());
  }
}

}  // namespace

MpcProblem parseProblem(const std::string& text, const std::string& source) {
  const YamlField root = YamlField::parse(text, source);
  // First: the keys of another type are not unknown.
  if (root.has("type")) requireProblemType(text, source, "tracking_mpc");
  root.checkKeys(
      {"polyfly_problem", "name", "type", "model", "sampling_time", "horizon", "weights", "parameters"},
      {"description", "provenance", "calibration"});
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
  readWeights(root.at("weights"), &problem);
  readParameters(root.at("parameters"), &problem);
  checkControllable(root, problem);
  return problem;
}

MpcProblem loadProblem(const std::string& path) { return parseProblem(readProblem(path), path); }

}  // namespace polyfly
