#include "mpc_core/decompositions.hpp"

#include <Eigen/Eigenvalues>

namespace polyfly {

Eigen::VectorXd symmetricEigenvalues(const Eigen::MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

SymmetricEigen symmetricEigen(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

OrthogonalFactors orthogonalFactors(const Eigen::MatrixXd& A) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(A);
  return {qr.householderQ(), qr.matrixQR().topRows(A.cols())};
}

// Eigen does not factorise a matrix without columns.
PivotedQr::PivotedQr(const Eigen::MatrixXd& A) : rows_(A.rows()), columns_(A.cols()) {
  if (!isEmpty()) qr_.compute(A);
}

PivotedQr::PivotedQr(const Eigen::MatrixXd& A, double threshold) : PivotedQr(A) {
  qr_.setThreshold(threshold);
}

Eigen::Index PivotedQr::rank() const { return isEmpty() ? 0 : qr_.rank(); }

Eigen::MatrixXd PivotedQr::Q() const {
  if (isEmpty()) return Eigen::MatrixXd::Identity(rows_, rows_);
  return qr_.householderQ();
}

Eigen::Index PivotedQr::column(Eigen::Index place) const { return qr_.colsPermutation().indices()(place); }

Eigen::VectorXd PivotedQr::solve(const Eigen::VectorXd& b) const {
  if (isEmpty()) return Eigen::VectorXd::Zero(columns_);
  return qr_.solve(b);
}

Eigen::MatrixXd PivotedQr::solve(const Eigen::MatrixXd& b) const {
  if (isEmpty()) return Eigen::MatrixXd::Zero(columns_, b.cols());
  return qr_.solve(b);
}

ShortestLeastSquares::ShortestLeastSquares(const Eigen::MatrixXd& A, double threshold) {
  factor_.setThreshold(threshold);
  factor_.compute(A);
}

ShortestLeastSquares::ShortestLeastSquares(const Eigen::MatrixXd& A) : factor_(A) {}

Eigen::VectorXd ShortestLeastSquares::solve(const Eigen::VectorXd& b) const { return factor_.solve(b); }

Eigen::MatrixXd ShortestLeastSquares::solve(const Eigen::MatrixXd& b) const { return factor_.solve(b); }

}  // namespace polyfly
