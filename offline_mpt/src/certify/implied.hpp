#pragma once

#include <vector>

#include "exact_kkt/exact_program.hpp"

namespace polyfly {

/// Proves the inequalities among `rows` to hold with equality wherever the program is feasible. False, and the
/// adjustment as it was, where that cannot be done.
bool proveImplied(const ParametricProgram& program, const std::vector<int>& rows,
                  ProgramPerturbation& adjustment);

}  // namespace polyfly
