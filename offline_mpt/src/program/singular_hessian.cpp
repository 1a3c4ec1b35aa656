#include "program/singular_hessian.hpp"

#include <algorithm>
#include <cmath>

#include "arithmetic/exact_numbers.hpp"
#include "mpc_core/decompositions.hpp"
#include "program/normalised_program.hpp"
#include "program/tolerances.hpp"

namespace polyfly {
namespace {

constexpr int kPenalties = 40;  // powers of 4 that are tried as a penalty

std::vector<Rational> fractionsOf(const Eigen::MatrixXd& matrix) {
  std::vector<Rational> values;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) values.emplace_back(matrix(i, j));
  }
  return values;
}

/// left * right', without rounding; both have `inner` columns.
std::vector<Rational> product(const std::vector<Rational>& left, const std::vector<Rational>& right,
                              int inner) {
  const std::size_t rows = left.size() / inner, columns = right.size() / inner;
  std::vector<Rational> result(rows * columns);
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      for (int k = 0; k < inner; ++k) result[i * columns + j] += left[i * inner + k] * right[j * inner + k];
    }
  }
  return result;
}

/// The range of H, rounded and, where `exact`, of the numbers as they are.
class Range {
 public:
  Range(const ParametricProgram& program, const std::vector<int>& basis, double penalty)
      : n_(program.variableCount()), whole_(fractionsOf(0.5 * (program.H + program.H.transpose()))) {
    Eigen::MatrixXd H = 0.5 * (program.H + program.H.transpose());
    for (const int row : basis) {
      H += penalty * program.A.row(row).transpose() * program.A.row(row);
      for (int i = 0; i < n_; ++i) {
        for (int j = 0; j < n_; ++j)
          whole_[i * n_ + j] += Rational(penalty) * Rational(program.A(row, i)) * Rational(program.A(row, j));
      }
    }
    const SymmetricEigen eigen = symmetricEigen(H);
    const double greatest = eigen.values.tail(1)(0);
    convex_ = eigen.values(0) >= -tolerance::kOutsideRange * greatest;
    int zeros = 0;
    while (zeros < n_ && eigen.values(zeros) <= tolerance::kNullEigenvalue * greatest) ++zeros;
    rank_ = n_ - zeros;
    null_ = eigen.vectors.leftCols(zeros);
    positive_ = eigen.values.tail(rank_);
    vectors_ = eigen.vectors.rightCols(rank_);
    IntegerMatrix integers = wholeRows(whole_, n_);
    long least = kNoBit;
    for (const Rational& value : whole_) include(least, value);
    for (int i = 0; i < n_ * n_; ++i) integers(i / n_, i % n_) = scaled(whole_[i], -least);
    exact_ = static_cast<int>(independentRows(integers).size()) == rank_ && positiveSemidefinite(integers);
  }

  bool convex() const { return convex_; }
  bool exact() const { return exact_; }

  bool holds(const Eigen::VectorXd& vector) const {
    return (null_.transpose() * vector).cwiseAbs().maxCoeff() <=
           tolerance::kOutsideRange * vector.cwiseAbs().maxCoeff();
  }

  /// The vector lies in the range of H without rounding.
  bool holdsExactly(const Eigen::VectorXd& vector) const {
    std::vector<Rational> rows = whole_;
    for (const Rational& value : fractionsOf(vector)) rows.push_back(value);
    return static_cast<int>(independentRows(wholeRows(rows, n_)).size()) == rank_;
  }

  /// The nearest in the range of H, or of its root.
  std::vector<Rational> nearest(const Eigen::VectorXd& vector) const {
    const Eigen::VectorXd weights = vectors_.transpose() * vector;
    if (exact_)
      return product(whole_, fractionsOf((vectors_ * weights.cwiseQuotient(positive_)).transpose()), n_);
    const Eigen::VectorXd part = weights.cwiseQuotient(positive_.cwiseSqrt());
    return product(root(), fractionsOf(part.transpose()), rank_);
  }

  std::vector<Rational> nearestHessian() const { return product(root(), root(), rank_); }

 private:
  std::vector<Rational> root() const { return fractionsOf(vectors_ * positive_.cwiseSqrt().asDiagonal()); }

  int n_;
  int rank_ = 0;
  bool convex_ = false, exact_ = false;
  std::vector<Rational> whole_;
  Eigen::MatrixXd null_, vectors_;
  Eigen::VectorXd positive_;
};

}  // namespace

bool isSingular(const ParametricProgram& program, const std::vector<int>& basis) {
  const int n = program.variableCount();
  Eigen::MatrixXd Z = Eigen::MatrixXd::Identity(n, n);
  if (!basis.empty()) {
    Eigen::MatrixXd A(n, static_cast<Eigen::Index>(basis.size()));
    for (std::size_t k = 0; k < basis.size(); ++k)
      A.col(static_cast<Eigen::Index>(k)) = program.A.row(basis[k]);
    const PivotedQr qr(A, tolerance::kEqualityRank);
    Z = qr.Q().rightCols(n - qr.rank());
  }
  const Eigen::MatrixXd reduced = Z.transpose() * program.H * Z;
  if (reduced.rows() == 0) return false;
  if (vanishes(reduced, program.H)) return true;
  const double mean = reduced.trace() / static_cast<double>(reduced.rows());
  return symmetricEigenvalues(reduced)(0) < tolerance::kSemidefinite * mean;
}

std::vector<ReplacedEntry> withoutRounding(const ParametricProgram& program, const std::vector<int>& basis,
                                           double& penalty) {
  using Matrix = ReplacedEntry::Matrix;
  const int n = program.variableCount();
  if (!basis.empty() && penalty == 0.0)
    penalty = std::ldexp(1.0, std::ilogb(program.H.cwiseAbs().maxCoeff()));
  Range range(program, basis, penalty);
  for (int k = 0; k < kPenalties && !range.convex() && !basis.empty(); ++k) {
    penalty *= 4.0;
    range = Range(program, basis, penalty);
  }
  std::vector<ReplacedEntry> replaced;
  if (!range.convex()) return replaced;
  if (!range.exact()) {
    const std::vector<Rational> H = range.nearestHessian();
    for (int i = 0; i < n * n; ++i) replaced.push_back({Matrix::kH, i / n, i % n, H[i]});
  }
  const auto replace = [&](const Eigen::VectorXd& vector, auto&& place) {
    if (vector.isZero(0.0) || !range.holds(vector) || (range.exact() && range.holdsExactly(vector))) return;
    const std::vector<Rational> nearest = range.nearest(vector);
    for (int j = 0; j < n; ++j) replaced.push_back(place(j, nearest[j]));
  };
  replace(program.f, [](int j, const Rational& value) { return ReplacedEntry{Matrix::kf, j, 0, value}; });
  for (int k = 0; k < program.parameterCount(); ++k) {
    replace(program.F.col(k), [k](int j, const Rational& value) {
      return ReplacedEntry{Matrix::kF, j, k, value};
    });
  }
  for (int i = 0; i < program.rowCount(); ++i) {
    replace(program.A.row(i).transpose(), [i](int j, const Rational& value) {
      return ReplacedEntry{Matrix::kA, i, j, value};
    });
  }
  return replaced;
}

}  // namespace polyfly
