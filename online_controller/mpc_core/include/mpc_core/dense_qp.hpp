#pragma once

#include <Eigen/Core>
#include <vector>

#include "mpc_core/qp_status.hpp"

namespace polyfly {

/// Strictly convex quadratic program
///
///     min_z 1/2 z'Hz + g'z   s.t.   A z <= b,   rows in `equalities` with "=".
///
/// Dual active-set method (Goldfarb and Idnani, 1983) on the Gram matrix A H^-1 A', whose Cholesky factor
/// follows the active set by up- and downdates. H and A are factorised once; then any (g, b) is solved
/// without allocation. One object serves one thread.
class DenseQp {
 public:
  /// H n x n positive definite, A m x n. Throws Error when H is not positive definite or sizes disagree.
  DenseQp(const Eigen::MatrixXd& H, const Eigen::MatrixXd& A, std::vector<int> equalities = {});

  /// At most 20 (m + n) + 100 changes of the active set. `g` n numbers, `b` m numbers. With `warm`, starts
  /// from the active set of the previous call.
  QpStatus solve(const double* g, const double* b, bool warm = false) noexcept;

  const Eigen::VectorXd& z() const noexcept { return z_; }  ///< minimiser, n
  const Eigen::VectorXd& lambda() const noexcept {
    return lambda_;
  }                                                                 ///< multipliers, m; >= 0 on inequalities
  const Eigen::VectorXd& slack() const noexcept { return slack_; }  ///< b - A z, m, of the normalised rows

  /// Rows that hold with equality and are linearly independent, in the order in which they joined.
  const int* activeRows() const noexcept { return active_.data(); }
  int activeCount() const noexcept { return active_count_; }
  int iterations() const noexcept { return iterations_; }

 private:
  enum class StepResult { kAdded, kInfeasible, kIterationLimit };

  bool startFrom(const double* g, const double* b) noexcept;
  void warmStart() noexcept;
  StepResult satisfy(int row) noexcept;
  bool append(int row) noexcept;
  void drop(int position) noexcept;
  void solveFactor(double* x) const noexcept;
  void resolveMultipliers() noexcept;
  void updateSlack() noexcept;
  int mostViolated() const noexcept;
  double largestMultiplier() const noexcept;
  bool finish() noexcept;

  int n_ = 0;
  int m_ = 0;
  int equality_count_ = 0;
  Eigen::MatrixXd H_inverse_;  // n x n
  Eigen::MatrixXd A_;          // m x n, rows of unit length in the norm of H^-1
  Eigen::MatrixXd W_;          // n x m, H^-1 A'
  Eigen::MatrixXd gram_;       // m x m, A H^-1 A', unit diagonal
  Eigen::VectorXd row_scale_;  // m
  std::vector<int> equalities_;
  std::vector<char> is_equality_;
  std::vector<char> is_active_;
  std::vector<char> is_void_;   // rows 0 z <= b
  Eigen::MatrixXd factor_;      // lower triangular, gram of the active rows
  Eigen::VectorXd z_free_, d_;  // unconstrained minimiser; slack there
  Eigen::VectorXd z_, lambda_, slack_;
  Eigen::VectorXd direction_;  // work space, as long as the active set
  std::vector<int> active_;
  int active_count_ = 0;
  int iterations_ = 0;
  int iteration_limit_ = 0;
};

}  // namespace polyfly
