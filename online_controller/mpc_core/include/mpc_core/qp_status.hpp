#pragma once

namespace polyfly {

/// How the search for the minimum of a quadratic program ended.
enum class QpStatus {
  kOptimal,
  /// The constraints contradict each other.
  kInfeasible,
  /// The solver reached its bound of iterations, or rounding prevented a solution.
  kIterationLimit,
  /// The data contain NaN, or infinity where it has no meaning.
  kNotFinite,
  /// The Hessian is not positive definite.
  kNotConvex,
};

}  // namespace polyfly
