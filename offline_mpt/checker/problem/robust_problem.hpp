#pragma once

#include <gmpxx.h>

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/program.hpp"

namespace checker {

/// A problem file of type robust_mpc (offline_mpt/robust/README.md). Numbers are exact as written.
struct RobustProblem {
  enum class Feedback { kFree, kZero, kFixed };
  /// Where the state must be in the invariant set.
  enum class Invariance { kNone, kFirstStep, kLastStep };
  /// A gain, or weights of its LQR.
  struct Gain {
    std::optional<Matrix> value, Q, R;
  };
  using Range = std::pair<Fraction, Fraction>;

  bool is_discrete = false;
  /// x' or x_{k+1} = A x + B u + G w, outputs C x.
  Matrix A, B, G, C;
  std::vector<Range> disturbances;
  /// Model and computed gains are rounded to multiples of 2^-bits.
  unsigned bits = 40;
  Fraction sampling_time;
  std::size_t horizon = 0;
  /// Stages x_{k+1} .. x_{k+N} instead of x_k .. x_{k+N-1}.
  bool is_shifted = false;
  Feedback feedback = Feedback::kFree;
  Gain tie_gain, feedback_gain;
  Invariance invariance = Invariance::kNone;
  bool has_peak = false;
  Fraction floor;
  /// By state.
  std::map<std::size_t, Range> state_ranges;
  Range input_range;

  /// Of the parameters: ranges, what a reference adds to x and u, and the parameter of each state's error.
  Matrix ranges, state_shift, input_shift;
  std::vector<std::size_t> errors;
};

/// Throws Refused, also for keys and choices that this checker does not know.
RobustProblem readRobustProblem(const std::string& text);

}  // namespace checker
