#pragma once

#include <vector>

#include "mpc_core/bounded_qp.hpp"
#include "mpc_core/stage_condensing.hpp"

namespace polyfly {

/// The roll loop over one step, the same at every stage: (phi, p)' = [[phi_phi, phi_p], [p_phi, p_p]] (phi,
/// p) + (phi_u, p_u) u.
struct RollTransition {
  double phi_phi = 1.0, phi_p = 0.0, phi_u = 0.0;
  double p_phi = 0.0, p_p = 1.0, p_u = 0.0;
};

/// One stage of the linearised problem, in deviations from the nodes about which it was linearised. The
/// states are (n, e, psi, phi, p); what is not listed is 1 on the diagonal and 0 elsewhere.
struct HorizonStage {
  // derivatives of the next n, e and psi
  double n_psi = 0.0, n_phi = 0.0, n_p = 0.0, n_u = 0.0;
  double e_psi = 0.0, e_phi = 0.0, e_p = 0.0, e_u = 0.0;
  double psi_phi = 0.0, psi_p = 0.0, psi_u = 0.0;
  double gap[5] = {0.0, 0.0, 0.0, 0.0, 0.0};  ///< end of the step from this node minus the next node
  // 1/2 x'Qx + q'x with Q symmetric; phi and p have diagonal entries only
  double Q_nn = 0.0, Q_ne = 0.0, Q_ee = 0.0, Q_npsi = 0.0, Q_epsi = 0.0, Q_psipsi = 0.0;
  double Q_phi = 0.0, Q_p = 0.0;
  double q[5] = {0.0, 0.0, 0.0, 0.0, 0.0};
  double R = 1.0;  ///< 1/2 R u^2 + r u, R > 0; not used on the last stage
  double r = 0.0;
};

/// Bounds on a deviation.
struct Interval {
  double lower = 0.0;
  double upper = 0.0;
};

/// The quadratic program of the Gauss-Newton iteration over the moves u_0 .. u_{N-1}:
///
///     min  sum_k 1/2 x_k'Q_k x_k + q_k'x_k + 1/2 R_k u_k^2 + r_k u_k + rho sum_k (excess of phi_k)
///     s.t. x_{k+1} = A_k x_k + B_k u_k + gap_k,  u_k within its bounds
///
/// The roll bounds are relaxed by an l1 term. Let rho be above the multipliers of the hard problem. Then the solution
/// is that of the hard problem where one exists, and the least sum of excesses where none does. So the problem always
/// has a solution.
///
/// It is condensed to the moves, which BoundedQp finds. One object serves one thread.
class HorizonQp {
 public:
  /// N >= 1 moves. Allocates here only; throws std::bad_alloc.
  explicit HorizonQp(int horizon);

  int horizon() const noexcept { return N_; }

  // What the caller fills before `prepare`.
  HorizonStage* stages() noexcept { return stages_.data(); }  ///< N + 1
  /// Bounds of u_k, N of them.
  Interval* moveBounds() noexcept { return bounds_.data(); }
  /// Bounds of phi_1 .. phi_N, N of them.
  Interval* rollBounds() noexcept { return &bounds_[N_]; }
  /// Transition of the roll loop, the same at every stage.
  RollTransition roll;
  /// Penalty weight of a radian of excess roll, > 0.
  double rho = 1e3;

  /// All that does not need x_0. False where a number is not finite or the curvature is not positive.
  bool prepare() noexcept;

  /// The solution from the deviation x_0 = (n, e, psi, phi, p). After `prepare`. At kIterationLimit the moves are those of
  /// the last iterate, within their bounds.
  QpStatus solve(const double* x_0) noexcept;

  const double* moves() const noexcept { return qp_.x(); }     ///< N
  const double* states() const noexcept { return x_.data(); }  ///< 5 (N + 1), stage by stage
  /// Of move k, or of phi_{k - N + 1} for k >= N; positive at the upper bound, negative at the lower.
  const double* multipliers() const noexcept { return multiplier_.data(); }  ///< 2 N
  int activeCount() const noexcept;
  int iterations() const noexcept { return qp_.iterations(); }

  /// Forgets the active set, as after a jump.
  void coldStart() noexcept;

 private:
  void linearTerms() noexcept;
  // The states from x_0 by the moves; without moves where there are none.
  void rollOut(const double* x_0, const double* moves) noexcept;

  int N_ = 0;
  std::vector<HorizonStage> stages_;
  std::vector<Interval> bounds_;
  StageCondensing<5, 1> condensing_;
  BoundedQp qp_;
  std::vector<double> x_;  // 5 (N + 1)
  std::vector<double> multiplier_;
  // Derivatives of phi_1 .. phi_N by the moves, column by column.
  std::vector<double> rows_;
  std::vector<double> gradient_, lower_, upper_;
  bool is_warm_ = false;
};

}  // namespace polyfly
