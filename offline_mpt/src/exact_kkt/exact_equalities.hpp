#pragma once

#include <vector>

#include "exact_kkt/exact_program.hpp"

namespace polyfly {

/// Of `rows`, which hold with equality, an independent set from which all others follow: the adjustment's
/// `basis`. Where rows depend on each other up to rounding, taken as they are they would fix z by what was
/// rounded, or contradict each other: such equalities are `dropped`, if their right-hand sides agree as well.
/// Replaces both.
void chooseBasis(const ParametricProgram& program, const std::vector<int>& rows,
                 ProgramPerturbation& adjustment);

}  // namespace polyfly
