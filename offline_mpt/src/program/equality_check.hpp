#pragma once

#include <Eigen/Core>
#include <vector>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// (A, S half, b + S centre) of the rows as columns, scaled to a length of one in A.
Eigen::MatrixXd unitColumns(const ParametricProgram& program, const std::vector<int>& rows);

/// Throws Error where rounding would decide what the program's equalities say: one depends on the others, but
/// not up to rounding, or one that does has another right-hand side.
void checkEqualities(const ParametricProgram& program);

}  // namespace polyfly
