#pragma once

#include <utility>

#include "made_robust.hpp"
#include "robust_mpc/robust_law.hpp"

namespace polyfly {

/// A problem with all that comes before its map.
struct SolvedRobust {
  RobustProblem problem;
  RobustProgram program;
  FeasibleSet set;
  RobustLaw law;

  explicit SolvedRobust(const MadeRobust& made, int threads = 1) : SolvedRobust(made.problem(), threads) {}

  explicit SolvedRobust(RobustProblem stated, int threads = 1) : problem(std::move(stated)) {
    program = buildRobustProgram(problem);
    ProjectOptions options;
    options.threads = threads;
    set = projectFeasibleSet(program, options);
    law = explicitLaw(problem, set);
  }
};

}  // namespace polyfly
