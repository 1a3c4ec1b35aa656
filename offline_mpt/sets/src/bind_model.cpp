#include <algorithm>

#include "polyfly_base/error.hpp"
#include "polytope_sets/analyze_map.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

void requireUnit(const Signal& signal, const Signal& of_map, const std::string& where) {
  if (signal.unit == of_map.unit) return;
  throw Error(where + ": '" + signal.name + "' has unit " + signal.unit + " in the model, " + of_map.unit +
              " in the map");
}

/// Place of each name in the map; throws Error when it is not there.
template <typename List>
std::size_t placeOf(const List& signals, const std::string& name, const std::string& where) {
  const auto found =
      std::find_if(signals.begin(), signals.end(), [&](const Signal& signal) { return signal.name == name; });
  if (found == signals.end()) throw Error(where + ": '" + name + "' of the model is not in the map");
  return static_cast<std::size_t>(found - signals.begin());
}

}  // namespace

ClosedLoopModel bindModel(const SetModel& model, const RegionMap& map) {
  const std::string where = map.path() + ", model " + model.name;
  const auto& parameters = map.parameters();
  const int p = static_cast<int>(parameters.size());
  std::vector<int> inputs, states, others;  // places in the map
  for (const Signal& input : model.inputs) {
    const std::size_t place = placeOf(map.inputs(), input.name, where + ": inputs");
    requireUnit(input, map.inputs()[place], where + ": inputs");
    inputs.push_back(static_cast<int>(place));
  }
  if (inputs.size() != map.inputs().size())
    throw Error(where + ": inputs: the map gives " + std::to_string(map.inputs().size()) +
                ", the model takes " + std::to_string(inputs.size()));
  for (const Signal& state : model.states) {
    states.push_back(static_cast<int>(placeOf(parameters, state.name, where + ": states")));
    requireUnit(state, parameters[static_cast<std::size_t>(states.back())], where + ": states");
  }
  for (const ModelParameter& parameter : model.parameters) {
    others.push_back(static_cast<int>(placeOf(parameters, parameter.signal.name, where + ": parameters")));
    requireUnit(parameter.signal, parameters[static_cast<std::size_t>(others.back())],
                where + ": parameters");
  }
  for (int j = 0; j < p; ++j) {
    if (std::count(states.begin(), states.end(), j) + std::count(others.begin(), others.end(), j) == 1)
      continue;
    throw Error(where + ": parameters: '" + parameters[static_cast<std::size_t>(j)].name +
                "' of the map is neither a state nor a parameter of the model");
  }
  ClosedLoopModel loop;
  loop.F = RationalMatrix(p, p);
  loop.G = RationalMatrix(p, static_cast<int>(inputs.size()));
  loop.E = RationalMatrix(p, model.disturbanceCount());
  loop.c.resize(static_cast<std::size_t>(p));
  loop.D = model.D;
  for (int i = 0; i < model.stateCount(); ++i) {
    const int row = states[static_cast<std::size_t>(i)];
    for (int j = 0; j < model.stateCount(); ++j)
      loop.F(row, states[static_cast<std::size_t>(j)]) = model.A(i, j);
    for (int j = 0; j < model.A_p.cols(); ++j)
      loop.F(row, others[static_cast<std::size_t>(j)]) = model.A_p(i, j);
    for (int j = 0; j < model.inputCount(); ++j)
      loop.G(row, inputs[static_cast<std::size_t>(j)]) = model.B(i, j);
    for (int j = 0; j < model.disturbanceCount(); ++j) loop.E(row, j) = model.E(i, j);
    loop.c[static_cast<std::size_t>(row)] = model.c[static_cast<std::size_t>(i)];
  }
  for (std::size_t k = 0; k < others.size(); ++k) {
    const int input = model.parameters[k].input;
    if (input < 0) {
      loop.F(others[k], others[k]) = 1;
    } else {
      loop.G(others[k], inputs[static_cast<std::size_t>(input)]) = 1;
    }
  }
  return loop;
}

}  // namespace polyfly
