#pragma once

#include <string>
#include <vector>

#include "linear_system.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/wide_matrix.hpp"

namespace polyfly {

/// The problem's file, or its name: where an error lies.
std::string placeOf(const MpcProblem& problem);

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

/// P of Eq. 4.
WideMatrix wideTerminalWeight(const MpcProblem& problem, const WideModel& model);

/// on_z z + on_theta theta, where z has no slacks yet.
struct Affine {
  WideMatrix on_z, on_theta;
};

/// Gains by which u~_k = -K_k (e_k, u~_{k-1}) + v_k makes the cost a sum over the stages: those of the problem's own Riccati
/// recursion. H is block diagonal, F theta is what a drift adds.
struct Feedback {
  std::vector<WideMatrix> K;  ///< nu x (nx + nu), of each stage
  WideMatrix H, F;
};

/// What happens over the horizon. z are the inputs u~ of each block, or v_k of each stage under a feedback.
struct Prediction {
  std::vector<Affine> errors;  ///< e_0 .. e_N
  std::vector<Affine> moves;   ///< u~_0 .. u~_{N-1}
};

Feedback feedbackOf(const MpcProblem& problem, const WideModel& model, const Selectors& selectors);

/// Without a feedback z are the inputs themselves.
Prediction predict(const MpcProblem& problem, const WideModel& model, const Selectors& selectors,
                   const Feedback* feedback);

/// The numbers of a ParametricProgram before they are rounded. Those of E are whole.
struct WideProgram {
  WideMatrix H, f, F, A, b, S, A_theta, b_theta, C, c;
};

/// Sets A, b, S, A_theta, b_theta, equalities and the names of the rows, and appends the slacks of the soft bounds to z with
/// their cost. H, f and F have been set for the inputs alone. Throws Error where a terminal equality cannot be met.
void setRows(const MpcProblem& problem, const Prediction& prediction, const Selectors& selectors,
             WideProgram* numbers, ParametricProgram* program);

/// Throws Error where rounding `numbers` to those of `program` may change an input by more than a millionth of its range.
void requireSmallRounding(const MpcProblem& problem, const Prediction& prediction, const WideProgram& numbers,
                          const ParametricProgram& program);

}  // namespace polyfly
