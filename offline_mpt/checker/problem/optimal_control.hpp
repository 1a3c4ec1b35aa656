#pragma once

#include <vector>

#include "problem/ball.hpp"
#include "problem/tracking_problem.hpp"

namespace checker {

/// x_{k+1} = A x_k + B u_k + B_d d_k, by the matrix exponential.
struct DiscreteSystem {
  BallMatrix A, B, B_d;
};
DiscreteSystem discretised(const TrackingProblem& problem);

/// P of the Riccati equation, to about 100 digits; it has no error of its own.
struct TerminalWeight {
  BallMatrix P;
  /// The greatest entry of A'PA - A'PB (R + B'PB)^-1 B'PA + Q - P is at most this.
  mpq_class residual;
};
/// Throws Refused where no P is found whose closed loop is stable.
TerminalWeight terminalWeight(const DiscreteSystem& system, const BallMatrix& Q, const BallMatrix& R);

/// on_z z <= bound + on_theta theta. Without z it bounds theta.
struct ExpectedRow {
  std::vector<Ball> on_z, on_theta;
  Ball bound;
  bool is_equality = false;
};

/// Eq. 4 and 38 as a program in z = (u~ of each block, slacks) and theta. F and C have the constant part, f and c, as
/// their last column; u = z_0 + C (theta, 1).
struct ExpectedProgram {
  BallMatrix H, F, C;
  std::vector<ExpectedRow> rows;
  /// 0 where P is given.
  mpq_class riccati_residual;
};
enum class Variables {
  kInputs,
  /// v_k = u~_k + K_k (e_k, u~_{k-1}), with the gains of the problem's own Riccati recursion. Any gains give the same problem.
  kBesideFeedback,
};
ExpectedProgram expectedProgram(const TrackingProblem& problem, Variables variables = Variables::kInputs);

/// K_k of each stage, to about 100 digits; they have no errors of their own.
std::vector<BallMatrix> feedbackGains(const TrackingProblem& problem, const DiscreteSystem& system,
                                      const BallMatrix& terminal_weight);

}  // namespace checker
