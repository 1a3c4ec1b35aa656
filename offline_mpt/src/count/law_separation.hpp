#pragma once

#include <Eigen/Core>
#include <vector>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// How clearly a row must be inactive in one region for a map to write another law there than where the row
/// is active: a map writes laws once whose coefficients hardly differ (kSameLaw). Known where the outputs
/// have every variable among them, and the variables are bounded; COUNT.md derives it.
struct LawSeparation {
  std::vector<double> slack;  ///< m, of the rows as they are; empty where it is not known
  Eigen::MatrixXd weights;    ///< 2 n x m: of the rows, >= 0 on inequalities; they sum to about z_j, and -z_j
};

LawSeparation findLawSeparation(const ParametricProgram& program);

}  // namespace polyfly
