#pragma once

#include <vector>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// Throws Error unless H is positive definite where `equalities`, rows that hold with "=", leave z free. What doubles do
/// not tell is decided in rational arithmetic on the program's numbers.
void requireDefinite(const ParametricProgram& program, const std::vector<int>& equalities);

}  // namespace polyfly
