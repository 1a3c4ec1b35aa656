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
  kFirstStep,  ///< A x + B u_0 + G w in the maximal robust control invariant set, for all w
  kTerminal,   ///< the last stage of the stack in that set, for all disturbances
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
    Signal signal;               ///< name, unit; bounds rounded
    Range range;                 ///< the box in which the law is computed
    int state = -1;              ///< which error it is; -1: a reference
    RationalVector state_shift;  ///< of a reference: nx
    RationalVector input_shift;  ///< of a reference: nu
  };

  std::string name;
  std::string description;
  std::string source;  ///< path it was read from, for messages
  std::string text;    ///< the file, verbatim

  std::vector<Signal> states;                      ///< names and units
  std::vector<std::optional<Range>> state_ranges;  ///< bounds on x, where there are any
  std::vector<Signal> inputs;
  std::vector<Range> input_ranges;   ///< bounds on u
  std::vector<Signal> disturbances;  ///< bounds rounded
  RationalMatrix A;                  ///< nx x nx, discrete time
  RationalMatrix B;                  ///< nx x nu
  RationalMatrix G;                  ///< nx x nw, times half the width of each channel's range
  RationalVector drift;              ///< nx, effect of the middle of the ranges
  RationalMatrix C;  ///< ny x nx; several outputs: the greatest of them counts, weigh by scaling

  double sampling_time = 0.0;  ///< [s]
  int horizon = 0;             ///< N
  Stack stack = Stack::kPaper;
  FeedbackPrediction feedback = FeedbackPrediction::kFree;
  RationalMatrix feedback_gain;  ///< nu x nx, with kFixed
  RationalMatrix tie_gain;       ///< nu x nx: among optimal first moves, the one nearest to K e
  Rational floor;                ///< tau >= floor >= 0: peaks below it are all alike
  InvarianceRule invariance = InvarianceRule::kNone;
  bool peak_in_map = false;  ///< the map gives tau as one more output
  std::vector<Parameter> parameters;

  int stateCount() const { return A.rows(); }
  int inputCount() const { return B.columns(); }
  int channelCount() const { return G.columns(); }
  int outputCount() const { return C.rows(); }
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
