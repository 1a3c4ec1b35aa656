#pragma once

#include <optional>
#include <string>
#include <vector>

#include "polytope_sets/exact_polytope.hpp"
#include "region_maps/signal.hpp"

namespace polyfly {

/// Which stages the stacked vectors of Eq. 9 and 10 hold.
enum class Stack {
  kPaper,  ///< x_k .. x_{k+N-1}, as printed: the last input has no effect
  kShift,  ///< x_{k+1} .. x_{k+N}: every input has one, the present state is not restricted
};

/// The matrix L of Eq. 15 and 16.
enum class FeedbackPrediction {
  kFree,   ///< chosen by the linear program
  kZero,   ///< L = 0: open-loop predictions
  kFixed,  ///< L_{ki} = K (A + B K)^(k-1-i) G with a given gain K
};

/// What is added so that feasibility is never lost.
enum class InvarianceRule {
  kNone,
  /// A x + B u_0 + G w lies in the maximal robust control invariant set, for all w.
  kFirstStep,
  /// The last stage of the stack lies in the maximal robust control invariant set, for all disturbances.
  kTerminal,
};

/// The minimum-peak robust MPC of Sect. 2.4: Eq. 8 with disturbances in a box, and Eq. 34. All numbers are
/// fractions; what was read in decimals counts as it was written.
///
///     e_{k+1} = A e_k + B u~_k + G s_k + drift,   |s_k| <= 1 in each channel
///     x_k = e_k + sum_j r_j state_shift_j,   u_k = u~_k + sum_j r_j input_shift_j,   peak of C e_k
///
/// theta holds one error per state and any number of references r_j, in the order of `parameters`.
struct RobustProblem {
  struct Range {
    Rational lower;
    Rational upper;
  };
  struct Parameter {
    /// Name and unit. The bounds are rounded.
    Signal signal;
    /// The box in which the law is computed.
    Range range;
    /// Index of the error's state. -1: the parameter is a reference.
    int state = -1;
    /// Shift of the state by a reference.
    RationalVector state_shift;  ///< nx
    /// Shift of the input by a reference.
    RationalVector input_shift;  ///< nu
  };

  std::string name;
  std::string description;
  /// Path of the file, for messages.
  std::string source;
  /// Text of the file, verbatim.
  std::string text;

  /// Names and units of the states.
  std::vector<Signal> states;
  /// Bounds on x. Empty: the state has no bounds.
  std::vector<std::optional<Range>> state_ranges;
  std::vector<Signal> inputs;
  /// Bounds on u.
  std::vector<Range> input_ranges;
  /// Disturbances with rounded bounds.
  std::vector<Signal> disturbances;
  RationalMatrix A;  ///< nx x nx, discrete time
  RationalMatrix B;  ///< nx x nu
  /// Effect of the disturbances, times half the width of each channel's range.
  RationalMatrix G;  ///< nx x nw
  /// Effect of the middle of the ranges.
  RationalVector drift;  ///< nx
  /// The greatest of several outputs counts, so scale outputs to weigh them.
  RationalMatrix C;  ///< ny x nx

  double sampling_time = 0.0;  ///< [s]
  int horizon = 0;             ///< N
  Stack stack = Stack::kPaper;
  FeedbackPrediction feedback = FeedbackPrediction::kFree;
  /// The given feedback gain, with kFixed.
  RationalMatrix feedback_gain;  ///< nu x nx
  /// Among optimal first moves, the law takes the one nearest to K e.
  RationalMatrix tie_gain;  ///< nu x nx
  /// tau >= floor >= 0. Peaks below the floor are equally good.
  Rational floor;
  InvarianceRule invariance = InvarianceRule::kNone;
  /// Whether the map gives tau as one more output.
  bool peak_in_map = false;
  std::vector<Parameter> parameters;

  int stateCount() const { return static_cast<int>(A.rows()); }
  int inputCount() const { return static_cast<int>(B.cols()); }
  int channelCount() const { return static_cast<int>(G.cols()); }
  int outputCount() const { return static_cast<int>(C.rows()); }
  int parameterCount() const { return static_cast<int>(parameters.size()); }
  /// Entries of theta that are errors, by state.
  std::vector<int> errorParameters() const;
};

/// Reads `type: robust_mpc` (offline_mpt/robust/README.md explains the keys). Throws Error
/// `file:line: field: rule`. Ranges that the file cites from others are put in their place: `text` has them
/// as numbers.
RobustProblem loadRobustProblem(const std::string& path);
RobustProblem parseRobustProblem(const std::string& text, const std::string& source);

/// Whether a problem file's `type` is robust_mpc. Throws Error when the text is no YAML.
bool isRobustProblem(const std::string& text, const std::string& source);

}  // namespace polyfly
