#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "mpc_core/aligned_array.hpp"
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
/// A row with an infinite penalty p_i (the default) is hard. A finite one relaxes it in the l1 norm: the row
/// holds exactly as long as its multiplier stays below p_i, and the problem always has a solution.
///
/// The first phase is a primal-dual active-set method (Kunisch and Rendl, 2003): it predicts all active bounds at once
/// from the signs of slacks and multipliers. On most control problems it ends in a few rounds, at the optimum of the
/// box. The second phase is for the rows, and for problems where the first does not end: a dual active-set method
/// (Goldfarb and Idnani, 1983), which is finite.
///
/// Each working set is factorised: the Hessian of the free variables or the Gram matrix A H^-1 A' of the active
/// constraints, whichever is less work. Rows and columns of a Gram matrix that did not change keep their factor. No
/// factor is updated, so no rounding is carried from one working set to the next.
///
/// After construction nothing allocates, throws or reads a clock. One object serves one thread. The same
/// calls give the same bits, with or without AVX2.
class BoundedQp {
 public:
  /// n variables and m rows. Throws Error unless n >= 1 and m >= 0.
  explicit BoundedQp(int variables, int rows = 0);

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
  void setIterationLimit(int limit) noexcept { iteration_limit_ = limit < 1 ? 1 : limit; }

  /// Starts from the working set `start` (n + m sides, bounds first; it may be activeSet() itself), or with
  /// nullptr from the empty one. At kIterationLimit and kInfeasible x() is the last point, moved into the
  /// box: it keeps lower <= x <= upper, but neither the optimum nor hard rows.
  QpStatus solve(const QpVectors& vectors, const QpSide* start = nullptr) noexcept;

  int variableCount() const noexcept { return n_; }
  int rowCount() const noexcept { return m_; }

  const double* x() const noexcept { return x_.data(); }  ///< minimiser, n

  /// Of the bounds (n), then of the rows (m): Hx + g + lambda_bounds + A' lambda_rows = 0, positive at an
  /// upper bound, negative at a lower one.
  const double* multipliers() const noexcept { return lambda_.data(); }

  const QpSide* activeSet() const noexcept { return side_.data(); }  ///< n + m, bounds first
  int iterations() const noexcept { return iterations_; }            ///< working sets tried

  /// Greatest violation of the KKT conditions at x() and multipliers(): stationarity relative to the
  /// greatest entry of g (at least 1), bounds, signs of multipliers and complementarity by the distance to
  /// the bound. Costs as much as n (n + m) multiplications; it shares nothing with the solution but H and A.
  double kktResidual() const noexcept;

  /// Greatest amount by which x() violates a row, 0 without rows.
  double violation() const noexcept { return violation_; }

 private:
  enum class Pass { kAdvanced, kOptimal, kInfeasible, kIterationLimit };
  struct Candidate {
    int index = -1;
    // Direction in which its multiplier moves.
    double direction = 0.0;
    // Violation over its scale.
    double violation = 0.0;
    QpSide reached = QpSide::kInactive;
  };

  QpStatus load(const QpVectors& vectors) noexcept;
  void startFrom(const QpSide* start) noexcept;
  QpSide allowed(int index, QpSide side) const noexcept;
  QpStatus finish(QpStatus status) noexcept;

  // The phases.
  bool predictBounds() noexcept;
  int correctPrediction() noexcept;
  void sweepBounds() noexcept;
  int dropWrongSigns() noexcept;
  double largestMultiplier() const noexcept;
  bool makeDualFeasible() noexcept;
  Pass ascend() noexcept;
  Candidate mostViolated() const noexcept;
  void considerSide(int index, double violation, double direction, QpSide reached,
                    Candidate& worst) const noexcept;
  double blockingStep(int* blocking) const noexcept;
  void release(int index) noexcept;
  void addToWorkingSet(const Candidate& candidate, bool was_relaxed) noexcept;

  // A working set as equalities.
  bool solveWorkingSet() noexcept;
  void listWorkingSet() noexcept;
  void listFree() noexcept;
  bool dualIsCheaper() const noexcept;
  bool factoriseWorkingSet() noexcept;
  bool factoriseDual() noexcept;
  bool factorisePrimal() noexcept;
  bool factoriseReduced() noexcept;
  bool factoriseGram(int count, int first) noexcept;
  void solveEquality() noexcept;
  void startFromBase() noexcept;
  void solveDirection(const Candidate& candidate) noexcept;
  void solveDual(double* x, double* lambda, bool homogeneous) noexcept;
  void solvePrimal(double* x, double* lambda, bool homogeneous) noexcept;
  void refine() noexcept;

  // Arithmetic with one constraint, or with the factors.
  double along(int index, const double* x) const noexcept;
  void addMultiple(int index, double factor, double* y) const noexcept;
  void evaluateRows() noexcept;
  const double* inverseColumn(int index) noexcept;
  void solveHessian(double* x) const noexcept;
  void solveGram(double* x) const noexcept;
  void solveReduced(double* x, bool lower, bool upper) const noexcept;
  void gatherFree(const double* from, double* to) const noexcept;
  static bool isHeld(QpSide side) noexcept { return side == QpSide::kLower || side == QpSide::kUpper; }
  bool isEquality(int index) const noexcept { return lower_[index] == upper_[index]; }
  double bound(int index) const noexcept {
    return side_[static_cast<std::size_t>(index)] < QpSide::kInactive ? lower_[index] : upper_[index];
  }
  // Visits the constraints whose multipliers are data: relaxed rows and the constraint that enters.
  template <class Visit>
  void forFixedMultipliers(const Visit& visit) {
    if (entering_ >= 0 && entering_ < n_) visit(entering_);
    for (int i = n_; i < n_ + m_; ++i) {
      const QpSide side = side_[static_cast<std::size_t>(i)];
      if (i == entering_ || side == QpSide::kLowerRelaxed || side == QpSide::kUpperRelaxed) visit(i);
    }
  }

  int n_ = 0;
  int m_ = 0;
  // Number of variables n in whole packs.
  int stride_ = 0;
  int iterations_ = 0;
  int iteration_limit_ = 0;
  bool convex_ = false;
  bool well_conditioned_ = false;
  bool has_hessian_inverse_ = false;
  bool has_equalities_ = false;
  double violation_ = 0.0;
  double gradient_scale_ = 0.0;

  AlignedArray H_, factor_, factor_inverse_;  // stride x n
  AlignedArray rows_;                         // stride x m, row by row
  AlignedArray inverse_;                      // stride x (n + m): H^-1 a_i
  // Least and greatest value that count as within the bounds, n + m.
  AlignedArray least_, greatest_;
  std::vector<char> has_inverse_;                 // n + m
  AlignedArray lower_, upper_, penalty_, scale_;  // n + m
  AlignedArray g_, base_;                         // n: gradient g, and -H^-1 g
  // Point, multipliers and row values; rates of the point and the multipliers.
  AlignedArray x_, lambda_, row_value_, dx_, dlambda_;
  bool has_base_ = false;
  // True when the first phase ended by itself.
  bool predicted_ = false;

  std::vector<QpSide> side_;  // n + m
  // Free variables; constraints held, bounds before rows.
  std::vector<int> free_, working_;
  // 1 where the bound of a variable is among those held, n.
  std::vector<char> listed_;
  int free_count_ = 0;
  // Number of bounds among the constraints held.
  int bound_count_ = 0;
  int working_count_ = 0;
  // Constraint on its way into the working set; -1: none.
  int entering_ = -1;
  // Constraint that depends on the others of the working set; -1: none.
  int dependent_ = -1;
  // True: the working set has the factor of its whole Gram matrix. False: that of the reduced Hessian.
  bool dual_ = false;
  // True when all variables are free: the reduced factor is that of H.
  bool all_free_ = false;
  int reduced_size_ = 0;
  int gram_size_ = 0;
  // Number of constraints at the head of the list that have a factor already.
  int gram_done_ = 0;
  // Factor of the Hessian of the free variables.
  AlignedArray reduced_, reduced_inverse_;
  // Factor of the Gram matrix.
  AlignedArray gram_, gram_inverse_;
  // Active rows, multiplied by the inverse of the reduced factor.
  AlignedArray range_;
  AlignedArray gradient_, work_, small_, multipliers_;
};

}  // namespace polyfly
