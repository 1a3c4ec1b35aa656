#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "parse_parts.hpp"

namespace polyfly {
namespace {

struct Role {
  const char* name;
  ParameterRole role;
  // What `of` names.
  const char* owner;
};

constexpr Role kRoles[] = {
    {"error", ParameterRole::kError, "a state"},
    {"previous_input", ParameterRole::kPreviousInput, "an input"},
    {"input_reference", ParameterRole::kInputReference, "an input"},
    {"state_reference", ParameterRole::kStateReference, "a state"},
    {"state", ParameterRole::kState, "a state"},
    {"reference", ParameterRole::kReference, "an output"},
    {"disturbance", ParameterRole::kDisturbance, "a disturbance"},
};

Role readRole(const YamlField& field) {
  const std::string name = field.text();
  std::string known;
  for (const Role& role : kRoles) {
    if (name == role.name) return role;
    known += (known.empty() ? "" : ", ") + std::string(role.name);
  }
  field.fail("must be one of " + known + ", got '" + name + "'");
}

const std::vector<Signal>& ownersOf(ParameterRole role, const MpcProblem& problem) {
  switch (role) {
    case ParameterRole::kError:
    case ParameterRole::kStateReference:
    case ParameterRole::kState:
      return problem.states;
    case ParameterRole::kPreviousInput:
    case ParameterRole::kInputReference:
      return problem.inputs;
    case ParameterRole::kReference:
      return problem.outputs;
    case ParameterRole::kDisturbance:
      return problem.disturbances;
  }
  return problem.states;
}

int ownerIndex(const YamlField& field, const Role& role, const MpcProblem& problem) {
  const std::vector<Signal>& owners = ownersOf(role.role, problem);
  const std::string of = field.name();
  const auto found =
      std::find_if(owners.begin(), owners.end(), [&](const Signal& signal) { return signal.name == of; });
  if (found == owners.end()) field.fail(std::string("must name ") + role.owner + ", got '" + of + "'");
  return static_cast<int>(found - owners.begin());
}

void readExtent(const YamlField& field, Signal* signal) {
  if (field.has("value")) {
    if (field.has("range")) field.at("value").fail("a fixed parameter has no range");
    signal->lower = signal->upper = field.at("value").number();
    return;
  }
  field.at("range").range(&signal->lower, &signal->upper);
}

/// Roles that exclude each other: errors with their references, or x itself with the references of Eq. 6.
void checkRoles(const YamlField& parameters, const MpcProblem& problem) {
  std::map<ParameterRole, std::set<int>> seen;
  for (const auto* list : {&problem.parameters, &problem.fixed_parameters})
    for (const MpcProblem::Parameter& parameter : *list) seen[parameter.role].insert(parameter.index);
  const bool absolute = seen.count(ParameterRole::kState) > 0;
  for (const Role& role : kRoles) {
    const bool of_errors = role.role == ParameterRole::kError ||
                           role.role == ParameterRole::kInputReference ||
                           role.role == ParameterRole::kStateReference;
    if (absolute && of_errors && seen.count(role.role) > 0)
      parameters.fail(std::string("role ") + role.name +
                      " does not go with role state: Eq. 6 gives the references");
  }
  if (!absolute && seen.count(ParameterRole::kReference) > 0)
    parameters.fail("role reference needs the states themselves (role state), not errors");
  const ParameterRole needed = absolute ? ParameterRole::kState : ParameterRole::kError;
  for (int i = 0; i < problem.stateCount(); ++i) {
    if (seen[needed].count(i) == 0) {
      parameters.fail(std::string("must have one with role ") + (absolute ? "state" : "error") +
                      " of state '" + problem.states[static_cast<std::size_t>(i)].name + "'");
    }
  }
  if (problem.parameters.empty()) parameters.fail("must not all be fixed");
}

}  // namespace

void readParameters(const YamlField& parameters, MpcProblem* problem) {
  std::set<std::string> taken;
  std::set<std::pair<ParameterRole, int>> targets;
  for (const YamlField& field : parameters.items()) {
    field.checkKeys({"name", "role", "of", "unit"}, {"range", "value"});
    MpcProblem::Parameter parameter;
    parameter.signal = readSignal(field, &taken);
    const Role role = readRole(field.at("role"));
    parameter.role = role.role;
    parameter.index = ownerIndex(field.at("of"), role, *problem);
    const Signal& owner = ownersOf(role.role, *problem)[static_cast<std::size_t>(parameter.index)];
    if (!targets.insert({parameter.role, parameter.index}).second)
      field.at("of").fail("another parameter has this role for '" + owner.name + "'");
    if (parameter.signal.unit != owner.unit)
      field.at("unit").fail("must be " + owner.unit + " as for '" + owner.name + "'");
    readExtent(field, &parameter.signal);
    (field.has("value") ? problem->fixed_parameters : problem->parameters).push_back(parameter);
  }
  checkRoles(parameters, *problem);
}

}  // namespace polyfly
