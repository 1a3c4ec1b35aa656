#pragma once

#include <Eigen/Core>

#include "mpc_core/mpc_problem.hpp"

namespace polyfly {

/// T e <= t with t = 1 but for rounding.
struct TerminalSet {
  Eigen::MatrixXd T;
  Eigen::VectorXd t;
  int iterations = 0;
};

/// The greatest set of errors from which u~ = -K e meets all hard bounds of the problem for ever, within the ranges
/// of the errors. K is the gain of the Riccati equation of (A, B, Q, R). The bounds hold for every reference in the
/// ranges of the parameters. The set is smaller than the greatest one by some 1e-6, so that the rounded numbers are
/// an invariant set too. This is proven in fractions. Throws Error where there is no such set, or where the recursion
/// does not end.
TerminalSet terminalSet(const MpcProblem& problem);

}  // namespace polyfly
