#pragma once

#include <gmpxx.h>

#include <optional>
#include <string>
#include <vector>

#include "problem/ball.hpp"

namespace checker {

/// A problem file of type tracking_mpc (region_maps/problems/README.md); numbers are doubles at their exact values.
struct TrackingProblem {
  struct Range {
    double lower = 0.0, upper = 0.0;
  };
  enum class Role { kError, kPreviousInput, kInputReference };
  struct Parameter {
    Role role = Role::kError;
    /// Of the state or input.
    std::size_t index = 0;
    Range range;
  };

  /// x' = A x + B u
  BallMatrix A, B;
  BallMatrix Q, R, R_delta;
  mpq_class sampling_time;
  std::size_t horizon = 0;
  /// None: unbounded.
  std::vector<std::optional<Range>> states;
  std::vector<Range> inputs;
  std::vector<Parameter> parameters;
};

/// Throws Refused, also for keys that this checker does not know.
TrackingProblem readTrackingProblem(const std::string& text);

}  // namespace checker
