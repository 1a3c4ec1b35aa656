#include "problem_types.hpp"

#include <algorithm>
#include <iterator>

#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/problem_type.hpp"
#include "polyfly_base/read_text.hpp"
#include "region_maps/region_map.hpp"
#include "safety_filter/safe_set.hpp"
#include "solve_report.hpp"
#include "verify_exact.hpp"

namespace polyfly {
namespace {

constexpr OwnSolver kOwnSolvers[] = {
    {"robust_mpc", solveRobust, verifyRobust},
};

const OwnSolver* ownSolver(const std::string& text, const std::string& source) {
  const ProblemType* type = problemTypeOf(text, source);
  if (type == nullptr) return nullptr;
  const auto* found = std::find_if(std::begin(kOwnSolvers), std::end(kOwnSolvers),
                                   [&](const OwnSolver& own) { return std::string(own.type) == type->name; });
  return found == std::end(kOwnSolvers) ? nullptr : found;
}

}  // namespace

ParametricProgram programOf(const VerifyArguments& options, const RegionMap& map) {
  if (!options.problem.empty()) return loadCompleteProgram(options.problem);
  return parseProgram(std::string(map.problemText()), std::string(map.problemKind()),
                      options.map + ": problem text");
}

const OwnSolver* ownSolverOf(const std::string& problem) {
  if (!endsWith(problem, ".yaml") && !endsWith(problem, ".yml")) return nullptr;
  return ownSolver(readText(problem), problem);
}

const OwnSolver* ownSolverOf(const RegionMap& map) {
  if (map.problemKind() != "yaml" || map.problemText().empty()) return nullptr;
  return ownSolver(std::string(map.problemText()), map.path() + ": problem text");
}

}  // namespace polyfly
