#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "region_maps/signal.hpp"

namespace polyfly {

/// A variable of a program by which a bound may be exceeded at a cost. It is at least 0 at every optimum.
struct SlackVariable {
  /// Index in z.
  int variable = 0;
  /// Rows A z <= b + S theta that the variable relaxes: the program without it has A with its column at 0.
  std::vector<int> rows;
  /// Row that keeps the variable at 0 or above; -1: none is needed.
  int floor = -1;
  /// Name of the bound, the same for all slacks of one bound, and unit.
  std::string name;
  std::string unit;
};

/// A multiparametric quadratic (H = 0: linear) program in theta:
///
///     min_z 1/2 z' H z + (f + F theta)' z   s.t.   A z <= b + S theta,  rows in `equalities` hold with "=",
///     lower <= theta <= upper,  A_theta theta <= b_theta
///
/// and the affine map from its minimiser to what the controller applies,
///
///     u = E z + C theta + c.
///
/// Sizes: z n, theta p, rows m, inputs q.
struct ParametricProgram {
  std::string name;
  /// Text of the problem file it came from, verbatim; may be empty.
  std::string text;
  std::string text_kind;  ///< "yaml" or "json"
  /// Sampling time of the controller [s]; 0 if there is none.
  double period = 0.0;

  Eigen::MatrixXd H;  ///< n x n, symmetric
  Eigen::VectorXd f;  ///< n
  Eigen::MatrixXd F;  ///< n x p
  Eigen::MatrixXd A;  ///< m x n
  Eigen::VectorXd b;  ///< m
  Eigen::MatrixXd S;  ///< m x p
  std::vector<int> equalities;
  /// What each of the m rows bounds, for people. Empty: not known.
  std::vector<std::string> row_names;
  /// The soft bounds. Empty: all rows are hard.
  std::vector<SlackVariable> slacks;

  /// Sentences about what the author of the problem may not have meant.
  std::vector<std::string> remarks;

  /// The p parameters, with the box lower .. upper.
  std::vector<Signal> parameters;
  Eigen::MatrixXd A_theta;  ///< k x p, may have no rows
  Eigen::VectorXd b_theta;  ///< k

  /// The q inputs, with the bounds of u (infinite where there are none).
  std::vector<Signal> inputs;
  Eigen::MatrixXd E;  ///< q x n
  Eigen::MatrixXd C;  ///< q x p
  Eigen::VectorXd c;  ///< q

  int variableCount() const { return static_cast<int>(H.rows()); }
  int parameterCount() const { return static_cast<int>(parameters.size()); }
  int rowCount() const { return static_cast<int>(A.rows()); }
  int inputCount() const { return static_cast<int>(inputs.size()); }
};

/// Throws Error naming `program.name` and the field. It throws when sizes disagree, an entry is not finite, or H is
/// not symmetric positive semidefinite. It also throws when an equality index is out of range, or a parameter's range
/// is empty or unbounded.
void checkProgram(const ParametricProgram& program);

/// The same; errors name `source`, the file that the program comes from, in place of the program.
void checkProgram(const ParametricProgram& program, const std::string& source);

/// Reads the generic JSON form (keys H f F A b B, eq_ids, lb ub A_theta b_theta, out; B is S here).
/// Throws Error naming file, field and rule.
ParametricProgram loadProgramJson(const std::string& path);
ParametricProgram parseProgramJson(const std::string& text, const std::string& source);

}  // namespace polyfly
