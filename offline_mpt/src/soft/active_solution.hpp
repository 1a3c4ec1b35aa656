#pragma once

#include <Eigen/Core>
#include <vector>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// z and the multipliers of an active set as affine functions of theta.
struct ActiveSolution {
  Eigen::MatrixXd on_theta;  ///< (n + active) x p
  Eigen::VectorXd constant;  ///< n + active
  /// The equations of the active set determine both.
  bool independent = false;
};

/// Solves the optimality conditions with the rows `active` as equalities, in doubles.
ActiveSolution solveActiveSet(const ParametricProgram& program, const std::vector<int>& active);

}  // namespace polyfly
