#include <string>

#include "mpc_core/problem_type.hpp"
#include "mpc_core/read_problem.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"

namespace polyfly {
ParametricProgram loadProgram(const std::string& path) {
  const bool yaml = endsWith(path, ".yaml") || endsWith(path, ".yml");
  if (!yaml && !endsWith(path, ".json")) throw Error(path + ": file: name must end in .yaml, .yml or .json");
  return yaml ? parseProgram(readProblem(path), "yaml", path) : parseProgram(readText(path), "json", path);
}

ParametricProgram parseProgram(const std::string& text, const std::string& kind, const std::string& source) {
  if (kind == "yaml") {
    const ProblemType* type = problemTypeOf(text, source);
    // The reader of the first type says what is wrong with a type that has no program, or is not known.
    return type != nullptr && type->program != nullptr ? type->program(text, source)
                                                       : condense(parseProblem(text, source));
  }
  if (kind == "json") return parseProgramJson(text, source);
  throw Error(source + ": text_kind: must be yaml or json, got '" + kind + "'");
}

}  // namespace polyfly
