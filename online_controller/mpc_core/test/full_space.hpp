#pragma once

#include <Eigen/Core>

#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/qp_status.hpp"

namespace polyfly_test {

/// Where a controller stands, in the problem's own coordinates.
struct Situation {
  Eigen::VectorXd x, x_ref, u_ref, u_previous;
  /// Constant part of x_{k+1} = A x_k + B u_k + w.
  Eigen::VectorXd w;
};

/// The optimum as the oracle has it.
struct FullSpaceAnswer {
  polyfly::QpStatus status = polyfly::QpStatus::kInfeasible;
  Eigen::MatrixXd u;       ///< nu x N
  Eigen::VectorXd excess;  ///< greatest slack of each entry of problem.constraints
};

/// Oracle of condense: the problem written out with all states, inputs and slacks as variables and the model as
/// equalities. It shares no code with condense. `A`, `B` and `P` are those of the prediction; Q and P must be positive
/// definite.
FullSpaceAnswer solveFullSpace(const polyfly::MpcProblem& problem, const polyfly::DiscreteModel& model,
                               const Eigen::MatrixXd& P, const Situation& at);

}  // namespace polyfly_test
