#pragma once

namespace polyfly {

/// How the search for the minimum of a quadratic program ended.
enum class QpStatus {
  kOptimal,
  kInfeasible,      ///< the constraints contradict each other
  kIterationLimit,  ///< the solver's bound of iterations was reached, or rounding prevented a solution
  kNotFinite,       ///< NaN, or infinity where it has no meaning
  kNotConvex,       ///< the Hessian is not positive definite
};

}  // namespace polyfly
