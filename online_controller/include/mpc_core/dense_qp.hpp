#pragma once

#include <Eigen/Core>
#include <vector>

namespace polyfly {

enum class QpStatus { kOptimal, kInfeasible, kIterationLimit };

/// Strictly convex QP  min 1/2 z'Hz + g'z  s.t.  A z <= b (rows in `equalities` with "="),
/// solved by a dual active-set method on the Gram matrix A H^-1 A'. Factorised once, then solved for any (g, b)
/// without allocation.
class DenseQp {
 public:
  /// H n x n positive definite, A m x n. Throws Error when H is not positive definite.
  DenseQp(const Eigen::MatrixXd& H, const Eigen::MatrixXd& A, std::vector<int> equalities = {});

  /// `g` n, `b` m. With `warm`, starts from the active set of the previous call. Never throws or allocates.
  QpStatus solve(const double* g, const double* b, bool warm = false) noexcept;

  const Eigen::VectorXd& z() const noexcept { return z_; }              ///< minimiser, n
  const Eigen::VectorXd& lambda() const noexcept { return lambda_; }    ///< multipliers, m, >= 0 on inequalities
  const std::vector<int>& activeSet() const noexcept { return active_; }  ///< sorted only after sortActive
  int iterations() const noexcept { return iterations_; }

 private:
  // completed by the implementation
  Eigen::VectorXd z_, lambda_;
  std::vector<int> active_;
  int iterations_ = 0;
};

}  // namespace polyfly
