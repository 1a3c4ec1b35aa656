#pragma once

#include <vector>

#include "mpc_core/bounded_qp.hpp"
#include "mpc_core/stage_condensing.hpp"

namespace polyfly {

/// One stage of the linearised problem, in deviations from the nodes about which it was linearised. The states are
/// (n, e, psi, phi, p).
struct HorizonStage {
  using State = Eigen::Matrix<double, 5, 1>;
  using Square = Eigen::Matrix<double, 5, 5>;
  static constexpr int kHeading = 2;
  static constexpr int kRoll = 3;
  static constexpr int kRollRate = 4;

  Square A = Square::Identity();
  State B = State::Zero();
  State gap = State::Zero();  ///< end of the step from this node minus the next node
  // 1/2 x'Qx + q'x + 1/2 R u^2 + r u with R > 0; without u on the last stage.
  Square Q = Square::Zero();
  State q = State::Zero();
  double R = 1.0;
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
  /// Penalty weight of a radian of excess roll, > 0.
  double rho = 1e3;

  /// All that does not need x_0. False where a number is not finite or the curvature is not positive.
  bool prepare() noexcept;

  /// The solution from the deviation x_0 = (n, e, psi, phi, p). After `prepare`. At kIterationLimit the moves are those of
  /// the last iterate, within their bounds.
  QpStatus solve(const double* x_0) noexcept;

  const double* moves() const noexcept { return qp_.x(); }                  ///< N
  const HorizonStage::State* states() const noexcept { return x_.data(); }  ///< N + 1
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
  std::vector<HorizonStage::State> x_;
  std::vector<double> multiplier_;
  // Derivatives of phi_1 .. phi_N by the moves, column by column.
  std::vector<double> rows_;
  std::vector<double> gradient_, lower_, upper_;
  bool is_warm_ = false;
};

}  // namespace polyfly
