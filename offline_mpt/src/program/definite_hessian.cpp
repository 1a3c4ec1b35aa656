#include "program/definite_hessian.hpp"

#include <utility>

#include "arithmetic/exact_matrix.hpp"
#include "mpc_core/decompositions.hpp"
#include "mpc_core/identity_form.hpp"
#include "polyfly_base/error.hpp"
#include "program/tolerances.hpp"

namespace polyfly {
namespace {

using Rows = std::vector<std::vector<Rational>>;

bool clearlyDefinite(const ParametricProgram& program, const std::vector<int>& equalities) {
  if (equalities.empty()) return choleskyRoot(wide(program.H)).has_value();
  Eigen::MatrixXd A(program.variableCount(), static_cast<Eigen::Index>(equalities.size()));
  for (Eigen::Index k = 0; k < A.cols(); ++k)
    A.col(k) = program.A.row(equalities[static_cast<std::size_t>(k)]).transpose();
  const PivotedQr qr(A, tolerance::kEqualityRank);
  const Eigen::MatrixXd Z = qr.Q().rightCols(A.rows() - qr.rank());
  const Eigen::MatrixXd reduced = Z.transpose() * program.H * Z;
  return reduced.rows() == 0 ||
         symmetricEigenvalues(reduced)(0) > tolerance::kClearlyDefinite * program.H.cwiseAbs().maxCoeff();
}

/// A basis of what the rows leave free, from their reduced echelon form.
Rows nullSpace(Rows rows, std::size_t n) {
  std::vector<std::size_t> pivots;
  for (std::size_t column = 0; column < n && pivots.size() < rows.size(); ++column) {
    const std::size_t next = pivots.size();
    std::size_t at = next;
    while (at < rows.size() && rows[at][column] == 0) ++at;
    if (at == rows.size()) continue;
    std::swap(rows[at], rows[next]);
    const Rational pivot = rows[next][column];
    for (Rational& value : rows[next]) value /= pivot;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Rational factor = rows[i][column];
      if (i == next || factor == 0) continue;
      for (std::size_t j = column; j < n; ++j) rows[i][j] -= factor * rows[next][j];
    }
    pivots.push_back(column);
  }
  Rows basis;
  for (std::size_t column = 0, next = 0; column < n; ++column) {
    if (next < pivots.size() && pivots[next] == column) {
      ++next;
      continue;
    }
    std::vector<Rational> vector(n);
    vector[column] = 1;
    for (std::size_t i = 0; i < pivots.size(); ++i) vector[pivots[i]] = -rows[i][column];
    basis.push_back(std::move(vector));
  }
  return basis;
}

/// Z'HZ, times a positive number.
IntegerMatrix reducedHessian(const ParametricProgram& program, const Rows& Z) {
  const auto n = static_cast<std::size_t>(program.variableCount());
  std::vector<Rational> values;
  Integer denominator(1);
  for (const std::vector<Rational>& left : Z) {
    std::vector<Rational> product(n);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n && left[i] != 0; ++j)
        product[j] +=
            left[i] * Rational(program.H(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
    }
    for (const std::vector<Rational>& right : Z) {
      Rational sum;
      for (std::size_t j = 0; j < n; ++j) sum += product[j] * right[j];
      denominator = lcm(denominator, sum.get_den());
      values.push_back(std::move(sum));
    }
  }
  const int size = static_cast<int>(Z.size());
  IntegerMatrix reduced(size, size);
  for (int i = 0; i < size * size; ++i)
    reduced(i / size, i % size) = Rational(values[static_cast<std::size_t>(i)] * denominator).get_num();
  // H counts as symmetric.
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j <= i; ++j) reduced(i, j) = reduced(j, i) = reduced(i, j) + reduced(j, i);
  }
  return reduced;
}

}  // namespace

void requireDefinite(const ParametricProgram& program, const std::vector<int>& equalities) {
  if (clearlyDefinite(program, equalities)) return;
  Rows rows;
  for (const int row : equalities) {
    rows.emplace_back();
    for (Eigen::Index j = 0; j < program.A.cols(); ++j) rows.back().emplace_back(program.A(row, j));
  }
  const IntegerMatrix reduced =
      reducedHessian(program, nullSpace(std::move(rows), static_cast<std::size_t>(program.variableCount())));
  const char* const where = equalities.empty() ? "" : " where the equalities leave z free";
  if (!positiveSemidefinite(reduced))
    throw Error(program.name + ": H: must be positive semidefinite" + where);
  if (static_cast<int>(independentRows(reduced).size()) < reduced.rows())
    throw Error(program.name + ": H: is singular" + where +
                ", and not zero: such a program is not solved; add a small multiple of the identity to H");
}

}  // namespace polyfly
