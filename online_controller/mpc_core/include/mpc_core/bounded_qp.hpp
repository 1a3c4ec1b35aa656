#pragma once

#include <cstdint>
#include <memory>

#include "mpc_core/qp_status.hpp"

namespace polyfly {

/// Where a constraint stands in a working set.
enum class QpSide : std::int8_t {
  kLowerRelaxed = -2,  ///< lower bound violated; its penalty is active
  kLower = -1,         ///< held at its lower bound
  kInactive = 0,
  kUpper = 1,         ///< held at its upper bound
  kUpperRelaxed = 2,  ///< upper bound violated; its penalty is active
};

/// The vectors of a quadratic program, read during the call only. Bounds may be infinite.
struct QpVectors {
  const double* g = nullptr;          ///< n
  const double* lower = nullptr;      ///< n
  const double* upper = nullptr;      ///< n; equal to `lower` where a variable is fixed
  const double* row_lower = nullptr;  ///< m; may stay nullptr without rows
  const double* row_upper = nullptr;  ///< m; equal to `row_lower` for an equality
};

/// Strictly convex quadratic program for control loops
///
///     min_x 1/2 x'Hx + g'x + sum_i p_i v_i   s.t.   lower <= x <= upper,
///                                                   row_lower - v <= A x <= row_upper + v,  v >= 0.
///
/// A row with an infinite penalty p_i (the default) is hard. A finite one relaxes it in the l1 norm, so the problem
/// always has a solution. The row holds exactly as long as its multiplier stays below p_i.
///
/// The first phase is a primal-dual active-set method (Kunisch and Rendl, 2003). It predicts all active bounds at
/// once from the signs of slacks and multipliers. On most control problems it ends in a few rounds, at the optimum of
/// the box. The second phase is for the rows, and for problems where the first does not end. It is a dual active-set
/// method (Goldfarb and Idnani, 1983), which is finite.
///
/// Each working set is factorised, by what is less work. That is the Hessian of the free variables or the Gram matrix
/// A H^-1 A' of the active constraints. Rows and columns of a Gram matrix that did not change keep their factor. No
/// factor is updated, so no rounding is carried from one working set to the next.
///
/// After construction nothing allocates, throws or reads a clock. One object serves one thread. The same
/// calls give the same bits, with or without AVX2. Moves, does not copy; an object that was moved from may only be
/// assigned to or destroyed.
class BoundedQp {
 public:
  /// n variables and m rows. Throws Error unless n >= 1 and m >= 0.
  explicit BoundedQp(int variables, int rows = 0);
  BoundedQp(BoundedQp&& other) noexcept;
  BoundedQp& operator=(BoundedQp&& other) noexcept;
  ~BoundedQp();

  /// Takes H, n x n, column by column (only its lower triangle is read), and factorises it: n^3 / 6
  /// multiplications. False, and kNotConvex from then on, when it is not positive definite or not finite.
  bool setHessian(const double* H) noexcept;

  /// As setHessian, and computes the inverse too: for an H that serves many solutions.
  bool setConstantHessian(const double* H) noexcept;

  /// Takes A, m x n, column by column.
  void setRows(const double* A) noexcept;

  /// Penalty p of a row, above 0; infinity makes it hard.
  void setPenalty(int row, double penalty) noexcept;

  /// Largest number of working sets that one solution may try, at least 1. Default: 10 (n + m) + 30.
  void setIterationLimit(int limit) noexcept;

  /// Starts from the working set `start` (n + m sides, bounds first; it may be activeSet() itself), or with
  /// nullptr from the empty one. At kIterationLimit and kInfeasible x() is the last point, moved into the
  /// box: it keeps lower <= x <= upper, but neither the optimum nor hard rows.
  QpStatus solve(const QpVectors& vectors, const QpSide* start = nullptr) noexcept;

  int variableCount() const noexcept;
  int rowCount() const noexcept;

  const double* x() const noexcept;  ///< minimiser, n

  /// Of the bounds (n), then of the rows (m): Hx + g + lambda_bounds + A' lambda_rows = 0, positive at an
  /// upper bound, negative at a lower one.
  const double* multipliers() const noexcept;

  const QpSide* activeSet() const noexcept;  ///< n + m, bounds first
  int iterations() const noexcept;           ///< working sets tried

  /// Greatest violation of the KKT conditions at x() and multipliers(). Stationarity is relative to the greatest
  /// entry of g (at least 1). A bound counts by how far it is exceeded. A multiplier off its bound counts by the
  /// distance to that bound, or by its own relative size where that is less. Costs as much as n (n + m)
  /// multiplications; it shares nothing with the solution but H and A.
  double kktResidual() const noexcept;

  /// Greatest amount by which x() violates a row, 0 without rows.
  double violation() const noexcept;

 private:
  class Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace polyfly
