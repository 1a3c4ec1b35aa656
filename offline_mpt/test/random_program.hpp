#pragma once

#include <Eigen/Core>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// A strictly convex program with random data, feasible around theta = 0, its box [-1, 1]^p.
ParametricProgram randomProgram(int n, int m, int p, unsigned seed);

/// One more row a'z <= b + s'theta.
void appendRow(ParametricProgram& program, const Eigen::VectorXd& a, double b, const Eigen::VectorXd& s);

/// A row once more, multiplied. With -1 the two are an equality.
void appendMultiple(ParametricProgram& program, int row, double factor);

/// All of z for output, named z_0, z_1, ..., instead of the first entry.
void outputAllVariables(ParametricProgram& program);

}  // namespace polyfly
