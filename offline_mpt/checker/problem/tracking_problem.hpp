#pragma once

#include <gmpxx.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "problem/ball.hpp"

namespace checker {

/// A problem file of type tracking_mpc (region_maps/problems/README.md); numbers are doubles at their exact values.
struct TrackingProblem {
  /// Infinite where there is no bound.
  struct Range {
    double lower = -HUGE_VAL, upper = HUGE_VAL;
  };
  enum class Role {
    kError,
    kPreviousInput,
    kInputReference,
    kStateReference,
    kState,
    kReference,
    kDisturbance,
  };
  struct Parameter {
    Role role = Role::kError;
    /// Of the state, input, output or disturbance.
    std::size_t index = 0;
    Range range;
    /// The value of a parameter that is no entry of theta.
    std::optional<double> fixed;
  };
  /// range holds on_x x_k + on_u u_k, or the same of the errors.
  struct Constraint {
    BallMatrix on_x, on_u;
    bool has_input = false;
    bool is_absolute = true;
    Range range;
    bool is_soft = false;
    double linear = 0.0, quadratic = 0.0;
    /// One slack for all stages.
    bool shares_slack = false;
  };

  bool is_discrete = false;
  /// x' or x_{k+1} = A x + B u + B_d d, y = C x
  BallMatrix A, B, B_d, C;
  BallMatrix Q, R, R_delta;
  /// None: that of the Riccati equation.
  std::optional<BallMatrix> P;
  /// x_N = x_ref
  bool ends_at_reference = false;
  /// T e_N <= t
  BallMatrix T, t;
  mpq_class sampling_time;
  /// Lengths of the blocks over which u is held.
  std::vector<std::size_t> blocks;
  std::vector<Range> states, inputs, changes;
  std::vector<Constraint> constraints;
  std::vector<Parameter> parameters;

  /// Number of parameters that are entries of theta.
  std::size_t freeCount() const;
};

/// Throws Refused, also for keys that this checker does not know.
TrackingProblem readTrackingProblem(const std::string& text);

}  // namespace checker
