#include "problem/tracking_problem.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/text.hpp"

namespace checker {
namespace {

constexpr std::size_t kMostSteps = 200;

void requireKeys(const YAML::Node& node, const std::set<std::string>& known) {
  for (const auto& entry : node) {
    const auto key = entry.first.as<std::string>();
    require(known.count(key) > 0, "problem: " + key + " is not known to this checker");
  }
}

double numberOf(const YAML::Node& node) {
  const auto value = node.as<double>();
  require(std::isfinite(value), "problem: a number is not finite");
  return value;
}

TrackingProblem::Range rangeOf(const YAML::Node& node) {
  require(node.IsSequence() && node.size() == 2, "problem: a range has two numbers");
  return {numberOf(node[0]), numberOf(node[1])};
}

BallMatrix matrixOf(const YAML::Node& node, std::size_t rows, std::size_t columns) {
  require(node.IsSequence() && node.size() == rows, "problem: a matrix has another size");
  BallMatrix result(rows, columns);
  for (std::size_t i = 0; i < rows; ++i) {
    require(node[i].IsSequence() && node[i].size() == columns, "problem: a matrix has another size");
    for (std::size_t j = 0; j < columns; ++j) result.at(i, j) = Ball(mpq_class(numberOf(node[i][j])));
  }
  return result;
}

/// A matrix, or its diagonal.
BallMatrix weightOf(const YAML::Node& node, std::size_t size) {
  require(node.IsSequence() && node.size() == size, "problem: a weight has another size");
  if (node[0].IsSequence()) return matrixOf(node, size, size);
  BallMatrix result(size, size);
  for (std::size_t i = 0; i < size; ++i) result.at(i, i) = Ball(mpq_class(numberOf(node[i])));
  return result;
}

/// Numbers of the names of a list of signals.
using Numbers = std::map<std::string, std::size_t>;

Numbers readModel(const YAML::Node& model, TrackingProblem& problem) {
  requireKeys(model, {"states", "inputs", "disturbances", "A", "B", "B_d", "C"});
  Numbers numbers;
  for (const auto& state : model["states"]) {
    requireKeys(state, {"name", "unit", "range"});
    numbers["x " + state["name"].as<std::string>()] = problem.states.size();
    problem.states.emplace_back();
    if (state["range"]) problem.states.back() = rangeOf(state["range"]);
  }
  for (const auto& input : model["inputs"]) {
    requireKeys(input, {"name", "unit", "range"});
    numbers["u " + input["name"].as<std::string>()] = problem.inputs.size();
    problem.inputs.push_back(rangeOf(input["range"]));
  }
  const std::size_t nx = problem.states.size(), nu = problem.inputs.size();
  require(nx > 0 && nu > 0, "problem: there are no states or inputs");
  problem.A = matrixOf(model["A"], nx, nx);
  problem.B = matrixOf(model["B"], nx, nu);
  return numbers;
}

void readWeights(const YAML::Node& weights, TrackingProblem& problem) {
  requireKeys(weights, {"Q", "R", "R_delta", "terminal"});
  const std::size_t nx = problem.states.size(), nu = problem.inputs.size();
  problem.Q = weightOf(weights["Q"], nx);
  problem.R = weightOf(weights["R"], nu);
  problem.R_delta = weights["R_delta"] ? weightOf(weights["R_delta"], nu) : BallMatrix(nu, nu);
  require(!weights["terminal"] || weights["terminal"].as<std::string>() == "riccati",
          "problem: weights.terminal is not known to this checker");
}

void readParameters(const YAML::Node& parameters, const Numbers& numbers, TrackingProblem& problem) {
  using Role = TrackingProblem::Role;
  const std::map<std::string, Role> roles = {{"error", Role::kError},
                                             {"previous_input", Role::kPreviousInput},
                                             {"input_reference", Role::kInputReference}};
  for (const auto& node : parameters) {
    requireKeys(node, {"name", "role", "of", "unit", "range"});
    const auto role = roles.find(node["role"].as<std::string>());
    require(role != roles.end(), "problem: a role is not known to this checker");
    const char* const kind = role->second == Role::kError ? "x " : "u ";
    const auto number = numbers.find(kind + node["of"].as<std::string>());
    require(number != numbers.end(), "problem: a parameter is of no state or input");
    problem.parameters.push_back({role->second, number->second, rangeOf(node["range"])});
  }
}

TrackingProblem read(const YAML::Node& root) {
  require(root.IsMap(), "problem: no map of keys");
  require(!root["H"], "problem: is a program in JSON, whose numbers check_certificate --problem compares");
  requireKeys(root, {"polyfly_problem", "name", "type", "description", "provenance", "model", "sampling_time",
                     "horizon", "weights", "parameters"});
  require(root["type"].as<std::string>() == "tracking_mpc", "problem: is of no type tracking_mpc");
  TrackingProblem problem;
  const Numbers numbers = readModel(root["model"], problem);
  problem.sampling_time = numberOf(root["sampling_time"]);
  problem.horizon = root["horizon"].as<std::size_t>();
  require(problem.sampling_time > 0 && problem.horizon >= 1 && problem.horizon <= kMostSteps,
          "problem: sampling_time or horizon is out of range");
  readWeights(root["weights"], problem);
  readParameters(root["parameters"], numbers, problem);
  return problem;
}

}  // namespace

TrackingProblem readTrackingProblem(const std::string& text) {
  try {
    return read(YAML::Load(text));
  } catch (const YAML::Exception& error) {
    throw Refused(std::string("problem: ") + error.what());
  }
}

}  // namespace checker
