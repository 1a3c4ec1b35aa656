#pragma once

#include <Eigen/Core>
#include <vector>

#include "explore/region/region_builder.hpp"
#include "mpc_core/dense_qp.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// Active set at t with all rows of unit length tightened by `margin`, ascending, of rows whose multipliers
/// exceed `least`; false where that is infeasible. `qp` has the reduced program's rows.
bool activeSetAt(const NormalisedProgram& program, DenseQp& qp, const Eigen::VectorXd& t, double margin,
                 double least, ActiveSet& active);

}  // namespace polyfly
