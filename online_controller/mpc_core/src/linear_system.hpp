#pragma once

#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/wide_matrix.hpp"

namespace polyfly {

// What mpc_problem.hpp declares in doubles, before it is rounded.

struct WideModel {
  WideMatrix A, B, Bd;
};

WideModel wideModel(const MpcProblem& problem, double period);

WideMatrix wideRiccati(const WideMatrix& A, const WideMatrix& B, const WideMatrix& Q, const WideMatrix& R);

/// (x, u)
WideMatrix wideSteadyState(const WideModel& model, const Eigen::MatrixXd& C, const Eigen::VectorXd& d,
                           const Eigen::VectorXd& r);

}  // namespace polyfly
