#include "explorer_content/explorer_content.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <string>

#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/safety_filter.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"
#include "robust_mpc/robust_problem.hpp"
#include "safety_filter/uncertain_model.hpp"

namespace polyfly {
namespace {

std::vector<double> rowMajor(const Eigen::MatrixXd& matrix) {
  std::vector<double> numbers;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) numbers.push_back(matrix(i, j));
  return numbers;
}

/// The text must be that of the map: the same parameters in the same order, and inputs that the map has.
void checkSignals(const RegionMap& map, const std::vector<Signal>& parameters,
                  const std::vector<Signal>& inputs) {
  bool same = parameters.size() == map.parameters().size() && inputs.size() <= map.inputs().size();
  for (std::size_t i = 0; same && i < parameters.size(); ++i)
    same = parameters[i].name == map.parameters()[i].name;
  for (std::size_t i = 0; same && i < inputs.size(); ++i) same = inputs[i].name == map.inputs()[i].name;
  if (!same) throw Error("its signals are not those of the map");
}

ExplorerProgram explorerProgram(const ParametricProgram& program, const Eigen::MatrixXd& rest) {
  ExplorerProgram result;
  result.variables = static_cast<std::size_t>(program.variableCount());
  result.H = rowMajor(program.H);
  result.f = rowMajor(program.f);
  result.F = rowMajor(program.F);
  result.A = rowMajor(program.A);
  result.b = rowMajor(program.b);
  result.S = rowMajor(program.S);
  result.equalities = program.equalities;
  result.rest = rowMajor(rest);
  return result;
}

void addTracking(const RegionMap& map, const std::string& text, const std::string& source,
                 ExplorerContent* content) {
  const MpcProblem problem = parseProblem(text, source);
  std::vector<Signal> parameters;
  for (const MpcProblem::Parameter& parameter : problem.parameters) parameters.push_back(parameter.signal);
  checkSignals(map, parameters, problem.inputs);
  const DiscreteModel discrete = discretise(problem, problem.sampling_time);
  ExplorerModel model;
  model.period = problem.sampling_time;
  model.input_count = problem.inputs.size();
  model.A = rowMajor(discrete.A);
  model.B = rowMajor(discrete.B);
  model.errors.resize(problem.states.size());
  bool flies_errors = problem.fixed_parameters.empty();
  Eigen::MatrixXd U =
      Eigen::MatrixXd::Zero(problem.inputCount(), static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t j = 0; j < problem.parameters.size(); ++j) {
    const auto index = static_cast<std::size_t>(problem.parameters[j].index);
    switch (problem.parameters[j].role) {
      case ParameterRole::kError:
        model.errors[index] = j;
        break;
      case ParameterRole::kPreviousInput:
        model.previous_inputs.push_back({j, index});
        break;
      case ParameterRole::kInputReference:
        U(problem.parameters[j].index, static_cast<Eigen::Index>(j)) = 1.0;
        break;
      case ParameterRole::kStateReference:
        break;
      case ParameterRole::kState:
      case ParameterRole::kReference:
      case ParameterRole::kDisturbance:
        flies_errors = false;
        break;
    }
  }
  model.U = rowMajor(U);
  const ParametricProgram program = condense(problem);
  if (flies_errors) {
    content->model = model;
  } else {
    content->no_model = "The page flies errors, and this map has other parameters. A click sets the state.";
  }
  content->program = explorerProgram(program, costAtZero(problem));
  content->constraints = program.row_names;
}

void addRobust(const RegionMap& map, const std::string& text, const std::string& source,
               ExplorerContent* content) {
  content->no_cost = "a map of a minimum-peak problem does not tell it";
  const RobustProblem problem = parseRobustProblem(text, source);
  std::vector<Signal> parameters;
  for (const RobustProblem::Parameter& parameter : problem.parameters) parameters.push_back(parameter.signal);
  checkSignals(map, parameters, problem.inputs);
  ExplorerModel model;
  model.period = problem.sampling_time;
  model.input_count = problem.inputs.size();
  model.A = rowMajor(toDoubles(problem.A));
  model.B = rowMajor(toDoubles(problem.B));
  for (const int error : problem.errorParameters()) model.errors.push_back(static_cast<std::size_t>(error));
  Eigen::MatrixXd U = Eigen::MatrixXd::Zero(problem.inputCount(), problem.parameterCount());
  for (Eigen::Index j = 0; j < U.cols(); ++j) {
    const RobustProblem::Parameter& parameter = problem.parameters[static_cast<std::size_t>(j)];
    if (parameter.state >= 0) continue;
    for (Eigen::Index i = 0; i < U.rows(); ++i)
      U(i, j) = parameter.input_shift[static_cast<std::size_t>(i)].get_d();
  }
  model.U = rowMajor(U);
  // G counts in half widths; the drift is the effect of the middle of the range.
  Eigen::MatrixXd G = toDoubles(problem.G);
  for (Eigen::Index k = 0; k < G.cols(); ++k) {
    const Signal& signal = problem.disturbances[static_cast<std::size_t>(k)];
    const double half = 0.5 * (signal.upper - signal.lower);
    if (half > 0.0) G.col(k) /= half;
  }
  model.G = rowMajor(G);
  model.disturbances = problem.disturbances;
  content->model = model;
  // Active sets of these maps are facets of the feasible set.
  std::int32_t last = -1;
  for (std::size_t i = 0; i < map.regionCount(); ++i) {
    const RegionView region = map.region(i);
    for (std::uint32_t k = 0; k < region.active_count; ++k) last = std::max(last, region.active[k]);
  }
  for (std::int32_t facet = 0; facet <= last; ++facet)
    content->constraints.push_back("facet " + std::to_string(facet) + " of the feasible set");
}

/// The wish is a parameter, constant over a flight. What the input does after its delay counts from the sample.
void addFilter(const RegionMap& map, const std::string& text, const std::string& source,
               ExplorerContent* content) {
  const SafetyFilterProblem problem = parseSafetyFilter(text, source);
  const ParametricProgram program = filterProgram(problem);
  checkSignals(map, program.parameters, program.inputs);
  const UncertainModel sampled = uncertainModel(problem);
  ExplorerModel model;
  model.period = problem.sampling_time;
  model.input_count = problem.inputs.size();
  model.A = rowMajor(toDoubles(sampled.A));
  model.B = rowMajor(toDoubles(sampled.B));
  for (std::size_t j = 0; j < static_cast<std::size_t>(sampled.stateCount()); ++j) model.errors.push_back(j);
  model.U = rowMajor(Eigen::MatrixXd::Zero(problem.inputCount(), program.parameterCount()));
  content->model = model;
  // (u - wish)' W (u - wish) / 2 without its part in u.
  const Eigen::Index p = program.parameterCount(), nu = problem.inputCount();
  Eigen::MatrixXd rest = Eigen::MatrixXd::Zero(p + 1, p + 1);
  rest.block(p - nu, p - nu, nu, nu) = 0.5 * program.H;
  content->program = explorerProgram(program, rest);
  content->constraints = program.row_names;
}

/// The cost of a generic program; it has no model.
void addGeneric(const RegionMap& map, const std::string& text, const std::string& source,
                ExplorerContent* content) {
  content->no_model =
      "The problem is a generic program without a model of a vehicle, so there is nothing to fly. A click "
      "sets the state.";
  const ParametricProgram program = parseProgramJson(text, source);
  checkSignals(map, program.parameters, program.inputs);
  const auto q = static_cast<Eigen::Index>(program.parameters.size()) + 1;
  content->program = explorerProgram(program, Eigen::MatrixXd::Zero(q, q));
}

void addProblem(const RegionMap& map, ExplorerContent* content) {
  const std::string text(map.problemText());
  const std::string source = map.path() + ": problem text";
  if (text.empty()) throw Error("it is empty");
  if (map.problemKind() == "json") {
    addGeneric(map, text, source, content);
  } else if (isSafetyFilter(text, source)) {
    addFilter(map, text, source, content);
  } else if (isRobustProblem(text, source)) {
    addRobust(map, text, source, content);
  } else {
    addTracking(map, text, source, content);
  }
}

}  // namespace

ExplorerContent explorerContent(const RegionMap& map) {
  ExplorerContent content;
  content.no_cost = "the map's problem text does not tell it";
  try {
    addProblem(map, &content);
  } catch (const Error& error) {
    content = {};
    content.no_cost = "the map's problem text does not tell it";
    content.no_model =
        std::string("The map's problem text cannot be used, so there is nothing to fly: ") + error.what();
  }
  if (map.reducedFrom() != 0) {
    // Regions of a reduced map join several active sets.
    content.program.reset();
    content.constraints.clear();
    content.no_cost = "a reduced map does not tell it";
  }
  return content;
}

}  // namespace polyfly
