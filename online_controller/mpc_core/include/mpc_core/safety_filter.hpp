#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "mpc_core/parametric_program.hpp"
#include "region_maps/signal.hpp"

namespace polyfly {

/// The safe set S and the admissible inputs, as `offline_mpt solve` computes them (offline_mpt/safety). xi is
/// the state, followed by the input before where there is a delay; n its size.
struct SafeSet {
  Eigen::MatrixXd H;  ///< rows x n; S = {xi : H xi <= k}
  Eigen::VectorXd k;
  Eigen::MatrixXd G;  ///< rows x nu; an input u is admissible at xi if G u <= b + M xi
  Eigen::VectorXd b;
  Eigen::MatrixXd M;  ///< rows x n
};

/// A problem of type safety_filter: of all inputs that keep the state in the safe set, the one nearest to the
/// wished input. offline_mpt/safety/README.md explains every key.
///
///     x' = A_c x + B_c u + Bd_c d,   x in its ranges at all times,   u held over a period
struct SafetyFilterProblem {
  std::string name;
  std::string description;
  /// Path of the file, for messages.
  std::string source;
  /// Text of the file, verbatim.
  std::string text;

  /// The nx states, with the ranges that the filter keeps.
  std::vector<Signal> states;
  /// Greatest error of each measured state [its unit].
  Eigen::VectorXd state_errors;
  /// The nu inputs, with the ranges of the actuator.
  std::vector<Signal> inputs;
  /// Greatest difference between the optimum and what is applied [unit of the input].
  Eigen::VectorXd input_errors;
  /// Weights of |u - wish|^2, above 0.
  Eigen::VectorXd weights;
  /// The nu wished inputs, with the ranges in which the map answers.
  std::vector<Signal> wishes;
  /// The nd disturbances with their ranges. They may vary in any way within a period.
  std::vector<Signal> disturbances;
  Eigen::MatrixXd A_c;         ///< nx x nx
  Eigen::MatrixXd B_c;         ///< nx x nu
  Eigen::MatrixXd Bd_c;        ///< nx x nd
  double sampling_time = 0.0;  ///< [s]
  /// From the sample to the moment when its input acts.
  double delay = 0.0;  ///< [s], 0 .. sampling_time
  /// How far the set stays below the maximal one, in parts of half of a state's range.
  double margin = 0.0;  ///< 1e-9 .. 0.1

  /// Absent in a file that a person wrote.
  std::optional<SafeSet> safe_set;

  int stateCount() const { return static_cast<int>(A_c.rows()); }
  int inputCount() const { return static_cast<int>(B_c.cols()); }
  /// Size n of xi.
  int augmentedCount() const { return stateCount() + (delay > 0.0 ? inputCount() : 0); }
  /// The entries of xi: the states, then NAME_before of each input where there is a delay.
  std::vector<Signal> augmentedStates() const;
};

/// Whether a problem text is of type safety_filter. Throws Error.
bool isSafetyFilter(const std::string& text, const std::string& source);

/// Reads a problem of type safety_filter. Throws Error `file:line: field: rule`.
SafetyFilterProblem parseSafetyFilter(const std::string& text, const std::string& source);

/// The multiparametric program of a problem: z = u, theta = (xi, wish). Throws Error when there is no safe
/// set.
ParametricProgram filterProgram(const SafetyFilterProblem& problem);

/// Text of a problem with its safe set as the last key, which parseSafetyFilter reads back to the same
/// numbers. The problem must not have one.
std::string withSafeSet(const SafetyFilterProblem& problem, const SafeSet& set);

}  // namespace polyfly
