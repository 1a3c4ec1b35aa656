#pragma once

#include "problem_types.hpp"

namespace polyfly {

/// Solves a problem of type robust_mpc.
ExitCode solveRobust(const SolveTask& task);

}  // namespace polyfly
