#include "problem/filter_problem.hpp"

#include "core/text.hpp"
#include "problem/fields.hpp"

namespace checker {
namespace {

// What a file says that does not say it.
constexpr double kInputError = 1e-6;
constexpr double kMargin = 1e-4;

constexpr std::size_t kMostStates = 6, kMostInputs = 3, kMostRows = 400;

double orElse(const YAML::Node& node, double absent) { return node ? numberOf(node) : absent; }

FilterProblem::Range filterRange(const YAML::Node& node) {
  const FilterProblem::Range range = rangeOf(node);
  require(range.first < range.second, "problem: a range is empty");
  return range;
}

double errorOf(const YAML::Node& node, double absent) {
  const double error = orElse(node, absent);
  require(error >= 0.0, "problem: an error is negative");
  return error;
}

void readFilterSignals(const YAML::Node& model, FilterProblem& problem) {
  for (const auto& state : model["states"]) {
    requireKeys(state, {"name", "unit", "range", "error"});
    problem.states.push_back(filterRange(state["range"]));
    problem.state_errors.push_back(errorOf(state["error"], 0.0));
  }
  for (const auto& input : model["inputs"]) {
    requireKeys(input, {"name", "unit", "range", "wish", "weight", "error"});
    problem.inputs.push_back(filterRange(input["range"]));
    problem.wishes.push_back(input["wish"] ? filterRange(input["wish"]) : problem.inputs.back());
    problem.weights.push_back(orElse(input["weight"], 1.0));
    require(problem.weights.back() > 0.0, "problem: a weight is not positive");
    problem.input_errors.push_back(errorOf(input["error"], kInputError));
  }
  for (const auto& disturbance : model["disturbances"]) {
    requireKeys(disturbance, {"name", "unit", "range"});
    problem.disturbances.push_back(filterRange(disturbance["range"]));
  }
  require(!problem.states.empty() && problem.states.size() <= kMostStates,
          "problem: 1 to 6 states are allowed");
  require(!problem.inputs.empty() && problem.inputs.size() <= kMostInputs,
          "problem: 1 to 3 inputs are allowed");
}

void readSafeSet(const YAML::Node& set, FilterProblem& problem) {
  require(set && set.IsMap(), "problem: safe_set is missing");
  requireKeys(set, {"H", "k", "G", "b", "M"});
  const std::size_t rows = set["H"].size();
  require(rows <= kMostRows, "problem: safe_set has too many rows");
  problem.H = matrixOf(set["H"], rows, problem.size());
  problem.k = columnOf(set["k"], rows);
  problem.G = matrixOf(set["G"], rows, problem.inputCount());
  problem.b = columnOf(set["b"], rows);
  problem.M = matrixOf(set["M"], rows, problem.size());
}

FilterProblem readFilter(const YAML::Node& root) {
  requireHead(root, "safety_filter",
              {"polyfly_problem", "name", "type", "description", "model", "sampling_time", "delay", "margin",
               "safe_set"});
  const YAML::Node model = root["model"];
  requireKeys(model, {"states", "inputs", "disturbances", "A", "B", "B_d"});
  FilterProblem problem;
  readFilterSignals(model, problem);
  const std::size_t nx = problem.stateCount(), nd = problem.disturbances.size();
  problem.A = BallMatrix(matrixOf(model["A"], nx, nx));
  problem.B = BallMatrix(matrixOf(model["B"], nx, problem.inputCount()));
  require(model["B_d"] || nd == 0, "problem: B_d is missing");
  problem.B_d = model["B_d"] ? BallMatrix(matrixOf(model["B_d"], nx, nd)) : BallMatrix(nx, 0);
  problem.sampling_time = numberOf(root["sampling_time"]);
  problem.delay = orElse(root["delay"], 0.0);
  problem.margin = orElse(root["margin"], kMargin);
  require(problem.sampling_time > 0.0 && problem.delay >= 0.0 && problem.delay <= problem.sampling_time &&
              problem.margin > 0.0,
          "problem: sampling_time, delay or margin is out of range");
  readSafeSet(root["safe_set"], problem);
  return problem;
}

}  // namespace

FilterProblem readFilterProblem(const std::string& text) { return withDocument(text, readFilter); }

}  // namespace checker
