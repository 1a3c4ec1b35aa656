#pragma once

#include <Eigen/Core>
#include <vector>

#include "mpc_core/mpc_problem.hpp"

namespace polyfly {

/// What theta says of the errors, the references and the previous input.
struct Selectors {
  Eigen::MatrixXd error;      ///< e_0 = error theta, nx x p
  Eigen::MatrixXd state;      ///< x_ref = state theta, nx x p
  Eigen::MatrixXd reference;  ///< u_ref = reference theta, nu x p
  Eigen::MatrixXd change;     ///< u_{-1} - u_ref = change theta, nu x p
  Eigen::MatrixXd drift;      ///< e_{k+1} = A e_k + B u~_k + drift theta, nx x p
  /// 1 where u_{-1} is a parameter, nu.
  std::vector<char> has_previous;
};

Selectors selectorsOf(const MpcProblem& problem, const DiscreteModel& model);

/// e_k = state[k-1] e_0 + input[k-1] z + drift[k-1] theta, k = 1..N, where z has no slacks yet.
struct Prediction {
  std::vector<Eigen::MatrixXd> state;
  std::vector<Eigen::MatrixXd> input;
  /// Empty where the errors do not drift.
  std::vector<Eigen::MatrixXd> drift;
};

/// Sets A, b, S, A_theta, b_theta and the names of the rows, and appends the slacks of the soft bounds to z with their
/// cost. H, f and F have been set for the inputs alone.
void setRows(const MpcProblem& problem, const Prediction& prediction, const Selectors& selectors,
             ParametricProgram* program);

}  // namespace polyfly
