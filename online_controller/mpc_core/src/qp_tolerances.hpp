#pragma once

namespace polyfly {

// Least pivot of a Hessian, relative to its diagonal.
constexpr double kPositive = 1e-15;
// Least pivot of constraints that count as independent, relative.
constexpr double kDependent = 1e-10;
// Least pivot of a constraint that has been let in before, relative.
constexpr double kIndependent = 1e-11;
// Violation that is left alone, relative to 1 + |bound|.
constexpr double kFeasible = 1e-11;
// Greatest multiplier of the wrong sign that counts as 0, relative.
constexpr double kRounding = 1e-13;
// Stationarity that is not improved, relative to the gradient's terms.
constexpr double kResidual = 1e-13;
// Greatest rate of a multiplier that does not block.
constexpr double kNegative = 1e-12;

/// Makes the columns and rows n .. stride-1 of a lower triangle those of the identity.
inline void setIdentityTail(double* matrix, int n, int stride_columns, int stride) {
  for (int j = 0; j < stride_columns; ++j) {
    for (int i = j < n ? n : j; i < stride_columns; ++i) matrix[j * stride + i] = i == j ? 1.0 : 0.0;
  }
}

inline void setIdentityTail(double* matrix, int n, int stride) { setIdentityTail(matrix, n, stride, stride); }

}  // namespace polyfly
