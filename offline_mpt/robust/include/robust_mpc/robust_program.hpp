#pragma once

#include <string>
#include <vector>

#include "robust_mpc/robust_problem.hpp"

namespace polyfly {

/// Eq. 21 with structural zeros dropped, in fractions:
///
///     min tau   s.t.   row.y . y + row.z . z + sum_t |term_t.constant + term_t.z . z| <= row.bound  for all
///     rows
///
/// y = (theta, u~_0, tau) is what the law is made of, z = (V_1 .., L) what is only predicted. A sum of
/// absolute values is the worst case over the box of disturbances (Eq. 24); entries of L and Gamma that have
/// no effect, or are constant, are no variables. It has the optimum of Eq. 34.
struct RobustProgram {
  enum class Kind {
    /// tau >= +-y_k (Eq. 25, 26).
    kPeak,
    /// tau >= floor.
    kFloor,
    /// Bounds on x (Eq. 31).
    kState,
    /// Bounds on u.
    kInput,
    /// First step or last stage in the invariant set.
    kInvariance,
    /// The box of theta.
    kBox,
  };
  struct Term {
    Rational constant;
    RationalVector z;
  };
  struct Row {
    Kind kind = Kind::kState;
    RationalVector y;
    RationalVector z;
    std::vector<Term> terms;  ///< each depends on z; constant ones are part of the bound
    Rational bound;

    bool hasPredictions() const;  ///< whether z takes part
  };

  int parameter_count = 0;   ///< np
  int prediction_count = 0;  ///< size of z
  std::vector<Row> rows;

  int lawSize() const { return parameter_count + 2; }  ///< size of y
  int inputEntry() const { return parameter_count; }
  int peakEntry() const { return parameter_count + 1; }
};

/// The program of a problem; with an invariance rule its set is computed first (exactly). Throws Error when
/// the problem has not one input, or that set is empty or not reached.
RobustProgram buildRobustProgram(const RobustProblem& problem);

/// The maximal robust control invariant set within all bounds on x and u, as half-spaces in theta. It is that of the
/// smallest part of theta that moves by itself and holds all bounded states. Throws Error naming the state that has
/// no range, or when the set is empty or not reached.
ExactPolytope invariantParameters(const RobustProblem& problem);

/// Sums of a row for given values; exact.
Rational rowExcess(const RobustProgram::Row& row, const RationalVector& y, const RationalVector& z);

}  // namespace polyfly
