#pragma once

namespace polyfly {

constexpr double kPositive = 1e-15;     // pivots of a Hessian, relative to its diagonal
constexpr double kDependent = 1e-10;    // pivots of constraints that count as independent, relative
constexpr double kIndependent = 1e-11;  // the same where the constraint has been let in before
constexpr double kFeasible = 1e-11;     // violation that is left alone, relative to 1 + |bound|
constexpr double kRounding = 1e-13;     // multipliers of the wrong sign up to here count as 0, relative
constexpr double kResidual = 1e-13;     // stationarity that is not improved, relative to the gradient's terms
constexpr double kNegative = 1e-12;     // rates of a multiplier that do not block

/// Makes the columns and rows n .. stride-1 of a lower triangle those of the identity.
inline void setIdentityTail(double* matrix, int n, int stride_columns, int stride) {
  for (int j = 0; j < stride_columns; ++j) {
    for (int i = j < n ? n : j; i < stride_columns; ++i) matrix[j * stride + i] = i == j ? 1.0 : 0.0;
  }
}

inline void setIdentityTail(double* matrix, int n, int stride) { setIdentityTail(matrix, n, stride, stride); }

}  // namespace polyfly
