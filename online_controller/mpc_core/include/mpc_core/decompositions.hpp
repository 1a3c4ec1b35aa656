#pragma once

#include <Eigen/Core>
#include <Eigen/QR>

namespace polyfly {

// Eigen's decompositions of matrices of any size. A file that uses Eigen's templates compiles them anew, which takes
// seconds for each; here they are compiled once.

/// Eigenvalues in rising order of a symmetric matrix, of which the lower triangle is read.
Eigen::VectorXd symmetricEigenvalues(const Eigen::MatrixXd& matrix);

/// A symmetric matrix as vectors * diag(values) * vectors'.
struct SymmetricEigen {
  /// Eigenvalues in rising order.
  Eigen::VectorXd values;
  /// Eigenvectors as orthonormal columns.
  Eigen::MatrixXd vectors;
};

SymmetricEigen symmetricEigen(const Eigen::MatrixXd& matrix);

/// A = Q R with Q square and orthogonal. A (n x k) has at least as many rows as columns.
struct OrthogonalFactors {
  Eigen::MatrixXd Q;  ///< n x n
  Eigen::MatrixXd R;  ///< k x k; only its upper triangle counts
};

OrthogonalFactors orthogonalFactors(const Eigen::MatrixXd& A);

/// A P = Q R with the columns of A in the order of their size, for a rank and for least squares. A may have no columns.
class PivotedQr {
 public:
  /// A diagonal entry of R that is not above `threshold` times the greatest one counts as zero.
  PivotedQr(const Eigen::MatrixXd& A, double threshold);
  /// Takes Eigen's threshold: the rounding of doubles.
  explicit PivotedQr(const Eigen::MatrixXd& A);

  Eigen::Index rank() const;
  /// Square. Its first rank() columns span the columns of A, the others the null space of A'.
  Eigen::MatrixXd Q() const;
  /// The column of A that stands at `place` in A P.
  Eigen::Index column(Eigen::Index place) const;

  /// x that makes A x - b shortest.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

 private:
  bool isEmpty() const { return rows_ == 0 || columns_ == 0; }

  Eigen::Index rows_, columns_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr_;
};

/// The shortest x among those that make A x - b shortest, for any rank.
class ShortestLeastSquares {
 public:
  /// An object that is only to be assigned to.
  ShortestLeastSquares() = default;
  /// Takes the threshold of PivotedQr.
  ShortestLeastSquares(const Eigen::MatrixXd& A, double threshold);
  explicit ShortestLeastSquares(const Eigen::MatrixXd& A);

  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;

 private:
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor_;
};

}  // namespace polyfly
