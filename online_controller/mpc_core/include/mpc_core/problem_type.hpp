#pragma once

#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "polyfly_base/yaml_field.hpp"

namespace polyfly {

/// What mpc_core, and with it everything that flies, knows of the problem files of one type. How the offline tool solves
/// and verifies a type is in a registry of its own: offline_mpt/app/problem_types.hpp.
struct ProblemType {
  /// Value of the key `type` of a problem file.
  const char* name;

  /// Reads the parametric program whose exploration gives the map. nullptr: the map is found by other means.
  ParametricProgram (*program)(const std::string& text, const std::string& source);

  /// Reads what a controller needs to fly the map, see parseFlightModel. nullptr: no controller flies it.
  MpcProblem (*flightModel)(const std::string& text, const std::string& source);
};

/// All types, in the order in which messages name them. A new type is a line here.
const std::vector<ProblemType>& problemTypes();

/// The type that a problem file names; nullptr where it names none of problemTypes(). Throws Error when the text is no
/// YAML.
const ProblemType* problemTypeOf(const std::string& text, const std::string& source);

/// Throws Error `source:line: type: rule` unless the problem file names `type`. The rule lists the types that there are.
void requireProblemType(const std::string& text, const std::string& source, const std::string& type);

/// Key `delay` of a problem's model, 0 .. 0.5 [s]; 0 where it is absent. Throws Error.
double readDelay(const YamlField& model);

/// The flight model of a robust_mpc, see parseFlightModel.
MpcProblem parseRobustFlightModel(const std::string& text, const std::string& source);

}  // namespace polyfly
