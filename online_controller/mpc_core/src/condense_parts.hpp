#pragma once

#include <vector>

#include "linear_system.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/wide_matrix.hpp"

namespace polyfly {

/// What theta says of the errors, the references and the previous input.
struct Selectors {
  WideMatrix error;      ///< e_0 = error theta, nx x p
  WideMatrix state;      ///< x_ref = state theta, nx x p
  WideMatrix reference;  ///< u_ref = reference theta, nu x p
  WideMatrix change;     ///< u_{-1} - u_ref = change theta, nu x p
  WideMatrix drift;      ///< e_{k+1} = A e_k + B u~_k + drift theta, nx x p
  /// 1 where u_{-1} is a parameter, nu.
  std::vector<char> has_previous;
};

Selectors selectorsOf(const MpcProblem& problem, const WideModel& model);

/// e_k = state[k-1] e_0 + input[k-1] z + drift[k-1] theta, k = 1..N, where z has no slacks yet.
struct Prediction {
  std::vector<WideMatrix> state;
  std::vector<WideMatrix> input;
  /// Empty where the errors do not drift.
  std::vector<WideMatrix> drift;
};

/// The numbers of a ParametricProgram before they are rounded. Those of E are whole.
struct WideProgram {
  WideMatrix H, f, F, A, b, S, A_theta, b_theta, C, c;
};

/// Sets A, b, S, A_theta, b_theta and the names of the rows, and appends the slacks of the soft bounds to z with their
/// cost. H, f and F have been set for the inputs alone.
void setRows(const MpcProblem& problem, const Prediction& prediction, const Selectors& selectors,
             WideProgram* numbers, ParametricProgram* program);

/// Throws Error where rounding `numbers` to those of `program` may change an input by more than a millionth of its range.
void requireSmallRounding(const MpcProblem& problem, const Prediction& prediction, const WideProgram& numbers,
                          const ParametricProgram& program);

}  // namespace polyfly
