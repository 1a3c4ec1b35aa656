#pragma once

#include "mpc_core/safety_filter.hpp"
#include "polytope_sets/rational.hpp"

namespace polyfly {

/// The sampled model of a safety filter with everything that is uncertain, in exact fractions:
///
///     xi+ = A xi + B u + c + w,   |w_i| <= W_i,   u in [u_lower, u_upper]
///
/// xi is the measured state, followed by the input before where there is a delay. Let xi be in [lower, upper] at the
/// samples, and in one convex set with all its successors. Then the true state is in the ranges of the problem at all
/// times.
struct UncertainModel {
  RationalMatrix A;  ///< n x n
  RationalMatrix B;  ///< n x nu
  RationalVector c;  ///< n
  RationalVector W;  ///< n
  /// The ranges of the states, less measurement error and excursion.
  RationalVector lower;    ///< n
  RationalVector upper;    ///< n
  RationalVector u_lower;  ///< nu
  RationalVector u_upper;  ///< nu
  /// How far a state bends out of the chord between two samples.
  RationalVector excursion;  ///< n
  /// Margin times half of upper - lower. Admissible inputs leave it free, for the answers of a map.
  RationalVector slack;  ///< n

  int stateCount() const { return static_cast<int>(A.rows()); }
  int inputCount() const { return static_cast<int>(B.cols()); }
};

/// Samples the model of a problem. W bounds a sum, entry by entry. Its terms are disturbances that vary in any way
/// within the period, errors of measurement at both samples, and the error of the applied input. Further terms are
/// what the series of the matrix exponential leaves out, and its rounding. Numbers of the problem count as the
/// doubles that they are. Throws Error when the period is too long for the model's fastest mode, or when a range
/// vanishes under errors and excursion.
UncertainModel uncertainModel(const SafetyFilterProblem& problem);

}  // namespace polyfly
