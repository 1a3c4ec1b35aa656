#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/program.hpp"
#include "problem/ball.hpp"

namespace checker {

/// A problem file of type safety_filter with its safe set (offline_mpt/safety/README.md). Numbers are doubles at their exact
/// values.
struct FilterProblem {
  using Range = std::pair<double, double>;

  /// x' = A x + B u + B_d d
  BallMatrix A, B, B_d;
  std::vector<Range> states, inputs, wishes, disturbances;
  /// Greatest errors of the measured states and of the applied inputs.
  std::vector<double> state_errors, input_errors;
  std::vector<double> weights;
  double sampling_time = 0.0, delay = 0.0, margin = 0.0;
  /// S = {xi: H xi <= k}; an input is admissible where G u <= b + M xi. xi is the state, with a delay also the input before.
  Matrix H, k, G, b, M;

  std::size_t stateCount() const { return states.size(); }
  std::size_t inputCount() const { return inputs.size(); }
  bool hasDelay() const { return delay > 0.0; }
  /// Of xi.
  std::size_t size() const { return stateCount() + (hasDelay() ? inputCount() : 0); }
};

/// Throws Refused, also for keys that this checker does not know.
FilterProblem readFilterProblem(const std::string& text);

}  // namespace checker
