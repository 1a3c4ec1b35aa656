#pragma once

#include <Eigen/Core>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// A parameter well inside the set for which the program has a solution.
struct SlaterPoint {
  bool feasible = false;
  Eigen::VectorXd t;  ///< p, scaled to [-1, 1]
};

/// Maximises the slack that all inequalities can have at once, over z and theta. Rows that can have none
/// hold with equality wherever the program is feasible (two opposite inequalities, say): they are added to
/// `program.equalities`, and the search is repeated. Throws Error when the parameters themselves are tied to
/// a lower-dimensional set.
SlaterPoint findSlaterPoint(ParametricProgram& program);

}  // namespace polyfly
