#pragma once

#include <algorithm>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// Whether the row of the program is one of its equalities.
inline bool isEquality(const ParametricProgram& program, int row) {
  return std::find(program.equalities.begin(), program.equalities.end(), row) != program.equalities.end();
}

/// Entry `i` of the row of (A, S, b).
inline double rowEntry(const ParametricProgram& program, int row, int i) {
  const int n = program.variableCount(), p = program.parameterCount();
  return i < n ? program.A(row, i) : i < n + p ? program.S(row, i - n) : program.b(row);
}

}  // namespace polyfly
