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
  Eigen::MatrixXd gram;         ///< m x m
  Eigen::MatrixXd D;            ///< m x (p + 1), constant last
  Eigen::VectorXd slope;        ///< m, length of a row of D but for its constant
  Eigen::VectorXd length;       ///< m, what the rows were divided by
  Eigen::MatrixXd domain;       ///< k x (p + 1), rows of A_theta as (a, b): a . t <= b, |a| = 1
  Eigen::VectorXd reach;        ///< m, greatest |D (t, 1)| in the box
  double noise = 0.0;           ///< relative error of gram and D, and of an operation with them
  std::vector<int> equalities;  ///< of the program
  std::vector<int> first_of;    ///< m, the first row of which row i is an exact positive multiple
};

}  // namespace polyfly
