#include <algorithm>

#include "mpc_core/problem_type.hpp"
#include "mpc_core/safety_filter.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/yaml_field.hpp"

namespace polyfly {
namespace {

ParametricProgram trackingProgram(const std::string& text, const std::string& source) {
  return condense(parseProblem(text, source));
}

ParametricProgram safetyProgram(const std::string& text, const std::string& source) {
  return filterProgram(parseSafetyFilter(text, source));
}

const ProblemType* findType(const std::string& name) {
  const std::vector<ProblemType>& types = problemTypes();
  const auto found =
      std::find_if(types.begin(), types.end(), [&](const ProblemType& type) { return name == type.name; });
  return found == types.end() ? nullptr : &*found;
}

/// `a, b or c`.
std::string listOfTypes() {
  const std::vector<ProblemType>& types = problemTypes();
  std::string list;
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (i > 0) list += i + 1 == types.size() ? " or " : ", ";
    list += types[i].name;
  }
  return list;
}

}  // namespace

const std::vector<ProblemType>& problemTypes() {
  static const std::vector<ProblemType> kTypes{
      {"tracking_mpc", trackingProgram, parseProblem},
      {"robust_mpc", nullptr, parseRobustFlightModel},
      {"safety_filter", safetyProgram, nullptr},
  };
  return kTypes;
}

const ProblemType* problemTypeOf(const std::string& text, const std::string& source) {
  const YamlField root = YamlField::parse(text, source);
  return root.has("type") ? findType(root.at("type").text()) : nullptr;
}

void requireProblemType(const std::string& text, const std::string& source, const std::string& type) {
  const YamlField field = YamlField::parse(text, source).at("type");
  const std::string name = field.text();
  if (name == type) return;
  const std::string rule = findType(name) != nullptr ? type + " here" : listOfTypes();
  field.fail("must be " + rule + ", got '" + name + "'");
}

// A file without a type, or with one that is not known, is told so by the reader of the first type.
MpcProblem parseFlightModel(const std::string& text, const std::string& source) {
  const ProblemType* type = problemTypeOf(text, source);
  if (type == nullptr) return parseProblem(text, source);
  if (type->flightModel == nullptr) {
    throw Error(source + ": type: no controller flies a map of a " + type->name);
  }
  return type->flightModel(text, source);
}

}  // namespace polyfly
