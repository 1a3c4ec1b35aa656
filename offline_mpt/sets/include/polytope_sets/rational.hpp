#pragma once

#include <gmpxx.h>

#include <cstddef>
#include <string>
#include <vector>

namespace polyfly {

using Integer = mpz_class;
using Rational = mpq_class;
using RationalVector = std::vector<Rational>;

/// Fractions, row-major.
class RationalMatrix {
 public:
  RationalMatrix() = default;
  RationalMatrix(int rows, int columns)
      : rows_(rows),
        columns_(columns),
        entries_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns)) {}
  static RationalMatrix identity(int size);

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  Rational& operator()(int row, int column) { return entries_[at(row, column)]; }
  const Rational& operator()(int row, int column) const { return entries_[at(row, column)]; }

 private:
  std::size_t at(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  int rows_ = 0;
  int columns_ = 0;
  std::vector<Rational> entries_;
};

/// a' b; both of one length.
Rational dot(const RationalVector& a, const RationalVector& b);

/// M x + m; an empty m counts as zero.
RationalVector affine(const RationalMatrix& M, const RationalVector& x, const RationalVector& m = {});

/// M' a.
RationalVector applyTransposed(const RationalMatrix& M, const RationalVector& a);

/// The double nearest to a fraction; of two equally near ones, the one farther from zero.
double nearestDouble(const Rational& value);

/// Reads "-3", "0.1" (one tenth, not the double beside it), "2.5e-3" or "1/3". False when it is none of
/// these, or an exponent exceeds +-400.
bool parseRational(const std::string& text, Rational& value);

}  // namespace polyfly
