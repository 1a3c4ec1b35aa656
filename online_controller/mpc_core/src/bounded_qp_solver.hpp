#pragma once

#include <cstddef>
#include <vector>

#include "mpc_core/aligned_array.hpp"
#include "mpc_core/bounded_qp.hpp"

namespace polyfly {

/// What BoundedQp does; its header documents the functions.
class BoundedQp::Solver {
 public:
  Solver(int variables, int rows);

  bool setHessian(const double* H) noexcept;
  bool setConstantHessian(const double* H) noexcept;
  void setRows(const double* A) noexcept;
  void setPenalty(int row, double penalty) noexcept;
  void setIterationLimit(int limit) noexcept { iteration_limit_ = limit < 1 ? 1 : limit; }
  QpStatus solve(const QpVectors& vectors, const QpSide* start) noexcept;

  int variableCount() const noexcept { return n_; }
  int rowCount() const noexcept { return m_; }
  const double* x() const noexcept { return x_.data(); }
  const double* multipliers() const noexcept { return lambda_.data(); }
  const QpSide* activeSet() const noexcept { return side_.data(); }
  int iterations() const noexcept { return iterations_; }
  double kktResidual() const noexcept;
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
  void relax(int index, bool upper) noexcept;
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
