#pragma once

#include <gmpxx.h>

#include <cstddef>
#include <vector>

namespace polyfly {

using Integer = mpz_class;
using Rational = mpq_class;

/// Whole numbers, row-major.
class IntegerMatrix {
 public:
  IntegerMatrix() = default;
  IntegerMatrix(int rows, int columns)
      : rows_(rows), columns_(columns), entries_(static_cast<std::size_t>(rows) * columns) {}

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  Integer& operator()(int row, int column) {
    return entries_[static_cast<std::size_t>(row) * columns_ + column];
  }
  const Integer& operator()(int row, int column) const {
    return entries_[static_cast<std::size_t>(row) * columns_ + column];
  }

 private:
  int rows_ = 0;
  int columns_ = 0;
  std::vector<Integer> entries_;
};

/// Solves M X = R for square M without a fraction (Bareiss, 1968). `system` is (M R); on return its last
/// columns hold N and X = N / determinant, with determinant > 0. False when M is singular; `system` is then
/// undefined.
bool solveExactly(IntegerMatrix& system, Integer& determinant);

/// Whether a symmetric matrix has no negative eigenvalue.
bool positiveSemidefinite(IntegerMatrix matrix);

/// Indices of rows that span all rows: each one is kept that does not depend on those before it.
std::vector<int> independentRows(IntegerMatrix matrix);

}  // namespace polyfly
