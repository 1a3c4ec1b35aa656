#pragma once

#include <Eigen/Core>
#include <vector>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// The slack of a row above which a map stores another law than in regions where the row is active. A map stores laws
/// as one whose coefficients hardly differ (kSameLaw). The bound is known where every variable is an output and the
/// variables are bounded; COUNT.md derives it.
struct LawSeparation {
  std::vector<double> slack;  ///< m, of the rows as they are; empty where it is not known
  Eigen::MatrixXd weights;    ///< 2 n x m: of the rows, >= 0 on inequalities; they sum to about z_j, and -z_j
};

LawSeparation findLawSeparation(const ParametricProgram& program);

}  // namespace polyfly
