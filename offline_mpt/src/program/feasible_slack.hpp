#pragma once

#include <Eigen/Core>
#include <optional>

#include "program/normalised_program.hpp"

namespace polyfly {

/// Greatest slack that all rows of the program, of unit length, can have at once at the scaled parameter t,
/// by the simplex method: negative where the program is infeasible there. Nothing where it cannot be told:
/// more variables than PolytopeSolver takes, or numerical breakdown.
std::optional<double> feasibleSlack(const NormalisedProgram& program, const Eigen::VectorXd& t);

}  // namespace polyfly
