#pragma once

#include <Eigen/Core>

#include "mpc_core/double_double.hpp"

namespace Eigen {

/// What Eigen has to know of the numbers.
template <>
struct NumTraits<polyfly::DoubleDouble> : GenericNumTraits<polyfly::DoubleDouble> {
  using Real = polyfly::DoubleDouble;
  using NonInteger = polyfly::DoubleDouble;
  using Nested = polyfly::DoubleDouble;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 2,
    AddCost = 20,
    MulCost = 20
  };

  static Real epsilon() { return polyfly::kDoubleDoubleUnit; }
  static Real highest() { return 1e300; }
  static Real lowest() { return -1e300; }
  static Real dummy_precision() { return 0x1p-90; }
  static int digits10() { return 30; }
};

}  // namespace Eigen

namespace polyfly {

/// About 32 digits, for what doubles would lose.
using WideMatrix = Eigen::Matrix<DoubleDouble, Eigen::Dynamic, Eigen::Dynamic>;

inline WideMatrix wide(const Eigen::MatrixXd& matrix) { return matrix.cast<DoubleDouble>(); }

/// Each number rounded.
inline Eigen::MatrixXd rounded(const WideMatrix& matrix) { return matrix.cast<double>(); }

}  // namespace polyfly
