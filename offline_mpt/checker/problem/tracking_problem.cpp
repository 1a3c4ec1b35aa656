#include "problem/tracking_problem.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>

#include "core/text.hpp"
#include "problem/fields.hpp"

namespace checker {
namespace {

using Role = TrackingProblem::Role;

constexpr std::size_t kMostSteps = 200;

Ball ballOf(const YAML::Node& node) { return Ball(mpq_class(numberOf(node))); }

TrackingProblem::Range boundsOf(const YAML::Node& node) {
  const auto [lower, upper] = rangeOf(node);
  return {lower, upper};
}

class Reader {
 public:
  explicit Reader(const YAML::Node& root) : root_(root) {}

  TrackingProblem read() {
    require(root_.IsMap(), "problem: no map of keys");
    require(!root_["H"], "problem: is a program in JSON, whose numbers check_certificate --problem compares");
    requireHead(
        root_, "tracking_mpc",
        {"polyfly_problem", "name", "type", "description", "provenance", "model", "sampling_time", "horizon",
         "moves", "control_horizon", "weights", "terminal_set", "constraints", "parameters"});
    readSignals(root_["model"]);
    readModel(root_["model"]);
    problem_.sampling_time = numberOf(root_["sampling_time"]);
    require(problem_.sampling_time > 0, "problem: sampling_time is out of range");
    readBlocks();
    readWeights(root_["weights"]);
    if (root_["terminal_set"]) readTerminalSet(root_["terminal_set"]);
    for (const auto& node : root_["constraints"]) readConstraint(node);
    for (const auto& node : root_["parameters"]) readParameter(node);
    return problem_;
  }

 private:
  /// Place of a name among signals of one kind: x, u, y or d.
  std::size_t placeOf(char kind, const std::string& name) const {
    const auto at = places_.find(kind + (" " + name));
    require(at != places_.end(), "problem: " + name + " is not known to this checker");
    return at->second;
  }
  bool isKnown(char kind, const std::string& name) const { return places_.count(kind + (" " + name)) > 0; }
  void addName(char kind, const YAML::Node& node, std::size_t place) {
    places_[kind + (" " + node["name"].as<std::string>())] = place;
  }

  void readSignals(const YAML::Node& model) {
    requireKeys(model,
                {"time", "states", "inputs", "disturbances", "outputs", "A", "B", "B_d", "C", "delay"});
    for (const auto& state : model["states"]) {
      requireKeys(state, {"name", "unit", "range"});
      addName('x', state, problem_.states.size());
      problem_.states.push_back(state["range"] ? boundsOf(state["range"]) : TrackingProblem::Range());
    }
    for (const auto& input : model["inputs"]) {
      requireKeys(input, {"name", "unit", "range", "change"});
      addName('u', input, problem_.inputs.size());
      problem_.inputs.push_back(boundsOf(input["range"]));
      problem_.changes.push_back(input["change"] ? boundsOf(input["change"]) : TrackingProblem::Range());
    }
    for (const auto& disturbance : model["disturbances"]) addName('d', disturbance, disturbance_count_++);
    std::size_t output_count = 0;
    for (const auto& output : model["outputs"]) addName('y', output, output_count++);
    require(!problem_.states.empty() && !problem_.inputs.empty(), "problem: there are no states or inputs");
  }

  void readModel(const YAML::Node& model) {
    const std::size_t nx = problem_.states.size(), nu = problem_.inputs.size();
    problem_.is_discrete = choiceOf(model["time"], {"continuous", "discrete"}) == 1;
    problem_.A = BallMatrix(matrixOf(model["A"], nx, nx));
    problem_.B = BallMatrix(matrixOf(model["B"], nx, nu));
    problem_.C = BallMatrix(matrixOf(model["C"], nu, nx));
    problem_.B_d =
        model["B_d"] ? BallMatrix(matrixOf(model["B_d"], nx, disturbance_count_)) : BallMatrix(nx, 0);
    if (model["outputs"]) return;
    // An output without a name of its own has that of the state which it is.
    for (const auto& state : model["states"]) {
      const std::size_t place = placeOf('x', state["name"].as<std::string>());
      for (std::size_t i = 0; i < nu; ++i) {
        if (isUnit(problem_.C, i, place)) addName('y', state, i);
      }
    }
  }

  static bool isUnit(const BallMatrix& matrix, std::size_t row, std::size_t place) {
    for (std::size_t j = 0; j < matrix.columns(); ++j) {
      if (matrix.at(row, j).distance(j == place ? 1 : 0) != 0) return false;
    }
    return true;
  }

  void readBlocks() {
    const auto horizon = countOf(root_["horizon"]);
    require(horizon >= 1 && horizon <= kMostSteps, "problem: horizon is out of range");
    if (root_["moves"]) {
      require(root_["moves"].IsSequence(), "problem: moves is no list");
      for (const auto& node : root_["moves"]) problem_.blocks.push_back(countOf(node));
    } else {
      const std::size_t count = root_["control_horizon"] ? countOf(root_["control_horizon"]) : horizon;
      require(count >= 1 && count <= horizon, "problem: control_horizon is out of range");
      problem_.blocks.assign(count, 1);
      problem_.blocks.back() += horizon - count;
    }
    std::size_t sum = 0;
    for (const std::size_t length : problem_.blocks) {
      require(length >= 1 && length <= horizon, "problem: moves: a block is out of range");
      sum += length;
    }
    require(sum == horizon, "problem: moves do not add up to the horizon");
  }

  void readWeights(const YAML::Node& weights) {
    requireKeys(weights, {"Q", "R", "R_delta", "terminal"});
    const std::size_t nx = problem_.states.size(), nu = problem_.inputs.size();
    problem_.Q = BallMatrix(weightOf(weights["Q"], nx));
    problem_.R = BallMatrix(weightOf(weights["R"], nu));
    problem_.R_delta = weights["R_delta"] ? BallMatrix(weightOf(weights["R_delta"], nu)) : BallMatrix(nu, nu);
    const YAML::Node terminal = weights["terminal"];
    if (terminal && terminal.IsSequence())
      problem_.P = BallMatrix(weightOf(terminal, nx));
    else
      problem_.ends_at_reference = choiceOf(terminal, {"riccati", "equality"}) == 1;
  }

  void readTerminalSet(const YAML::Node& node) {
    requireKeys(node, {"T", "t"});
    const std::size_t rows = node["T"].size();
    problem_.T = BallMatrix(matrixOf(node["T"], rows, problem_.states.size()));
    problem_.t = BallMatrix(columnOf(node["t"], rows));
  }

  void readConstraint(const YAML::Node& node) {
    requireKeys(node, {"of", "name", "unit", "range", "lower", "upper", "measured_from", "soft"});
    TrackingProblem::Constraint constraint;
    constraint.on_x = BallMatrix(1, problem_.states.size());
    constraint.on_u = BallMatrix(1, problem_.inputs.size());
    if (node["of"].IsMap()) {
      for (const auto& term : node["of"])
        addTerm(term.first.as<std::string>(), ballOf(term.second), constraint);
    } else {
      addTerm(node["of"].as<std::string>(), Ball(1), constraint);
    }
    if (node["range"]) constraint.range = boundsOf(node["range"]);
    if (node["lower"]) constraint.range.lower = numberOf(node["lower"]);
    if (node["upper"]) constraint.range.upper = numberOf(node["upper"]);
    constraint.is_absolute = choiceOf(node["measured_from"], {"zero", "reference"}) == 0;
    if (node["soft"]) readSoft(node["soft"], constraint);
    problem_.constraints.push_back(constraint);
  }

  void addTerm(const std::string& name, const Ball& coefficient,
               TrackingProblem::Constraint& constraint) const {
    const bool is_state = isKnown('x', name);
    BallMatrix& on = is_state ? constraint.on_x : constraint.on_u;
    on.at(0, placeOf(is_state ? 'x' : 'u', name)) += coefficient;
    constraint.has_input = constraint.has_input || !is_state;
  }

  static void readSoft(const YAML::Node& soft, TrackingProblem::Constraint& constraint) {
    requireKeys(soft, {"linear", "quadratic", "slack"});
    constraint.is_soft = true;
    if (soft["linear"]) constraint.linear = numberOf(soft["linear"]);
    constraint.quadratic = numberOf(soft["quadratic"]);
    constraint.shares_slack = choiceOf(soft["slack"], {"stage", "horizon"}) == 1;
  }

  void readParameter(const YAML::Node& node) {
    requireKeys(node, {"name", "role", "of", "unit", "range", "value"});
    const std::map<std::string, std::pair<Role, char>> roles = {
        {"error", {Role::kError, 'x'}},
        {"previous_input", {Role::kPreviousInput, 'u'}},
        {"input_reference", {Role::kInputReference, 'u'}},
        {"state_reference", {Role::kStateReference, 'x'}},
        {"state", {Role::kState, 'x'}},
        {"reference", {Role::kReference, 'y'}},
        {"disturbance", {Role::kDisturbance, 'd'}}};
    const auto role = roles.find(node["role"].as<std::string>());
    require(role != roles.end(), "problem: a role is not known to this checker");
    TrackingProblem::Parameter parameter;
    parameter.role = role->second.first;
    parameter.index = placeOf(role->second.second, node["of"].as<std::string>());
    if (node["value"])
      parameter.fixed = numberOf(node["value"]);
    else
      parameter.range = boundsOf(node["range"]);
    problem_.parameters.push_back(parameter);
  }

  const YAML::Node root_;
  std::map<std::string, std::size_t> places_;
  std::size_t disturbance_count_ = 0;
  TrackingProblem problem_;
};

}  // namespace

std::size_t TrackingProblem::freeCount() const {
  return static_cast<std::size_t>(std::count_if(parameters.begin(), parameters.end(),
                                                [](const Parameter& parameter) { return !parameter.fixed; }));
}

TrackingProblem readTrackingProblem(const std::string& text) {
  return withDocument(text, [](const YAML::Node& root) { return Reader(root).read(); });
}

}  // namespace checker
