#pragma once

#include <vector>

#include "exact_kkt/exact_program.hpp"

namespace polyfly {

/// Proves the inequalities among `rows` to hold with equality wherever the program is feasible, or, where
/// their bounds leave less between them than what the solver tells from nothing, wherever it is with bounds
/// in the middle, which then count instead. False, and the adjustment as it was, where neither can be done.
bool proveImplied(const ParametricProgram& program, const std::vector<int>& rows,
                  ProgramPerturbation& adjustment);

}  // namespace polyfly
