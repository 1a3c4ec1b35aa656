#pragma once

#include <Eigen/Core>

#include "robust_mpc/robust_problem.hpp"

namespace polyfly {

/// Eq. 34 as it is printed, in doubles, nothing left out:
///
///     min c'z  s.t.  A z <= b + S theta,   z = (V, L, tau, Gamma, Omega)
///
/// V has N inputs, and L is that of Eq. 16, by rows of its strictly lower blocks. Gamma has one entry for each output
/// of each stage and disturbance, Omega likewise for each row of E_x and E_u. Besides Eq. 34: tau >= floor, the rows
/// of an invariance rule, and L held at its values where it is not free.
struct FullProgram {
  Eigen::VectorXd c;
  Eigen::MatrixXd A;
  Eigen::VectorXd b;
  Eigen::MatrixXd S;
  int first_input = 0;  ///< entry of z that is u~_0
  int peak = 0;         ///< entry of z that is tau
};
FullProgram buildFullProgram(const RobustProblem& problem);

}  // namespace polyfly
