#pragma once

#include <gmpxx.h>

#include <Eigen/Core>
#include <string>
#include <vector>

/// What Eigen asks of the numbers of a matrix.
template <>
struct Eigen::NumTraits<mpq_class> : Eigen::GenericNumTraits<mpq_class> {
  using Real = mpq_class;
  using NonInteger = mpq_class;
  using Nested = mpq_class;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 10,
    AddCost = 100,
    MulCost = 100
  };
};

namespace polyfly {

using Integer = mpz_class;
using Rational = mpq_class;
using RationalVector = std::vector<Rational>;

/// Fractions. The entries of a new one are 0.
using RationalMatrix = Eigen::Matrix<Rational, Eigen::Dynamic, Eigen::Dynamic>;

/// The doubles of a matrix, exactly.
RationalMatrix exactly(const Eigen::MatrixXd& matrix);

/// Each entry rounded to the nearest double.
Eigen::MatrixXd toDoubles(const RationalMatrix& matrix);

/// a' b; both of one length.
Rational dot(const RationalVector& a, const RationalVector& b);

/// M x + m; an empty m counts as zero.
RationalVector affine(const RationalMatrix& M, const RationalVector& x, const RationalVector& m = {});

/// M' a.
RationalVector applyTransposed(const RationalMatrix& M, const RationalVector& a);

/// The double nearest to a fraction; of two equally near ones, the one farther from zero.
double nearestDouble(const Rational& value);

/// The multiple of `step` nearest to a fraction; of two equally near ones, the greater.
Rational nearestMultiple(const Rational& value, const Rational& step);

/// Reads "-3", "0.1" (one tenth, not the double beside it), "2.5e-3" or "1/3". False when it is none of
/// these, or an exponent exceeds +-400.
bool parseRational(const std::string& text, Rational& value);

}  // namespace polyfly
