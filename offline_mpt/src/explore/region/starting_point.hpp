#pragma once

#include <Eigen/Core>
#include <vector>

#include "explore/region/region_builder.hpp"
#include "mpc_core/dense_qp.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// Active set at t with all rows of unit length tightened by `margin`, ascending, of rows with multipliers; false where
/// that is infeasible. `qp` is min 1/2 v'v + g'v with the reduced program's rows. Where H is zero, |v|^2 has a small weight
/// beside the cost.
bool activeSetAt(const NormalisedProgram& program, DenseQp& qp, const Eigen::VectorXd& t, double margin,
                 ActiveSet& active);

}  // namespace polyfly
