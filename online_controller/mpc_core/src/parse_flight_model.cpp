#include <algorithm>
#include <limits>

#include "mpc_core/problem_type.hpp"
#include "polyfly_base/yaml_field.hpp"

namespace polyfly {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

std::vector<Signal> readSignals(const YamlField& list, bool with_range) {
  std::vector<Signal> signals;
  for (const YamlField& field : list.items()) {
    Signal signal{field.at("name").name(), field.at("unit").unit(), -kNoLimit, kNoLimit};
    if (with_range) field.at("range").range(&signal.lower, &signal.upper);
    signals.push_back(std::move(signal));
  }
  return signals;
}

void readModel(const YamlField& model, MpcProblem& problem) {
  if (model.has("time") && model.at("time").text() != "continuous")
    model.at("time").fail("must be continuous to be flown");
  problem.states = readSignals(model.at("states"), false);
  problem.inputs = readSignals(model.at("inputs"), true);
  problem.disturbances = readSignals(model.at("disturbances"), true);
  const int nx = static_cast<int>(problem.states.size());
  problem.A_c = model.at("A").matrix(nx, nx);
  problem.B_c = model.at("B").matrix(nx, static_cast<int>(problem.inputs.size()));
  problem.Bd_c = model.at("G").matrix(nx, static_cast<int>(problem.disturbances.size()));
  problem.delay = readDelay(model);
}

void readErrors(const YamlField& parameters, MpcProblem& problem) {
  for (const YamlField& field : parameters.items()) {
    if (field.at("role").text() != "error") continue;
    MpcProblem::Parameter parameter;
    parameter.signal = {field.at("name").name(), field.at("unit").unit(), 0.0, 0.0};
    field.at("range").range(&parameter.signal.lower, &parameter.signal.upper);
    const std::string of = field.at("of").name();
    const auto found = std::find_if(problem.states.begin(), problem.states.end(),
                                    [&](const Signal& state) { return state.name == of; });
    if (found == problem.states.end()) field.at("of").fail("must name a state, got '" + of + "'");
    parameter.index = static_cast<int>(found - problem.states.begin());
    problem.parameters.push_back(std::move(parameter));
  }
}

}  // namespace

double readDelay(const YamlField& model) {
  constexpr double kGreatest = 0.5;  // [s]
  if (!model.has("delay")) return 0.0;
  const double delay = model.at("delay").number();
  if (!(delay >= 0.0 && delay <= kGreatest)) model.at("delay").fail("must be from 0 to 0.5 s");
  return delay;
}

MpcProblem parseRobustFlightModel(const std::string& text, const std::string& source) {
  const YamlField root = YamlField::parse(text, source);
  MpcProblem problem;
  problem.source = source;
  problem.text = text;
  problem.minimum_peak = true;
  problem.name = root.at("name").name();
  readModel(root.at("model"), problem);
  problem.sampling_time = root.at("sampling_time").number();
  if (!(problem.sampling_time > 0.0)) root.at("sampling_time").fail("must be greater than 0");
  readErrors(root.at("parameters"), problem);
  return problem;
}

}  // namespace polyfly
