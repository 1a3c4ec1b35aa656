#pragma once

#include <Eigen/Core>
#include <vector>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// A strictly convex program reduced to all of its rows, none dropped, each divided by its length in the norm
/// of H^-1. With multipliers lambda of the rows so divided,
///
///     slack(t) = D (t, 1) + gram lambda,   theta = centre + half .* t.
///
/// Computed with more digits than doubles have, and rounded once.
struct StrictComplementaritySystem {
  /// Throws Error when H is not positive definite.
  explicit StrictComplementaritySystem(const ParametricProgram& program);

  int m = 0;
  int p = 0;
  Eigen::MatrixXd gram;  ///< m x m
  /// Slack without multipliers, constant last.
  Eigen::MatrixXd D;  ///< m x (p + 1)
  /// Length of each row of D without its constant.
  Eigen::VectorXd slope;  ///< m
  /// Lengths by which the rows were divided.
  Eigen::VectorXd length;  ///< m
  /// Rows of A_theta as (a, b): a . t <= b, |a| = 1.
  Eigen::MatrixXd domain;  ///< k x (p + 1)
  /// Greatest |D (t, 1)| in the box.
  Eigen::VectorXd reach;  ///< m
  /// Relative error of gram and D, and of an operation with them.
  double noise = 0.0;
  /// Rows of the program that are equalities.
  std::vector<int> equalities;
  /// First row of which row i is an exact positive multiple.
  std::vector<int> first_of;  ///< m
};

}  // namespace polyfly
