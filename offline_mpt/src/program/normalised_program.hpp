#pragma once

#include <Eigen/Core>
#include <vector>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// Share of the mean eigenvalue below which the least one makes H singular.
constexpr double kSemidefinite = 1e-8;

/// Eigenvalues of a singular H below this share of the greatest are zero.
constexpr double kNullEigenvalue = 1e-12;

/// H is zero where the equalities leave z free, `reduced`, but for rounding.
inline bool vanishes(const Eigen::MatrixXd& reduced, const Eigen::MatrixXd& H) {
  constexpr double kRounding = 1e-13;
  return reduced.cwiseAbs().maxCoeff() <= kRounding * H.cwiseAbs().maxCoeff();
}

/// A parametric program brought to the form in which it is explored.
///
/// Parameters are scaled, theta = centre + half .* t with t in [-1, 1]^p; equalities are eliminated; rows
/// that repeat or are implied by a parallel row are dropped; rows have unit length in the norm of H^-1. With
/// multipliers lambda of the rows left,
///
///     slack(t) = D (t, 1) + gram lambda,   u(t) = U (t, 1) + V lambda.
///
/// A linear program (H = 0) is the limit of H = eps I for eps -> 0, taken symbolically: of all optima the one
/// of least length |z| is chosen, which is unique and, where the cost does not depend on theta, continuous.
/// Multipliers are then cost multipliers / eps + lambda with cost + M' cost multipliers = 0, and all of the above holds with the
/// lambda of order one. H that is singular otherwise is the limit of H + eps I, which the equation above does
/// not describe: ShortestOptimum does. D, U and V are then those of H = I without cost.
struct NormalisedProgram {
  int p = 0;                   ///< parameters
  int n = 0;                   ///< variables left
  int m = 0;                   ///< rows left
  Eigen::VectorXd centre;      ///< p
  Eigen::VectorXd half;        ///< p
  std::vector<int> row_ids;    ///< m, rows of the program
  Eigen::MatrixXd M;           ///< m x n, unit rows A L^-T with H = L L'
  Eigen::MatrixXd gram;        ///< m x m, M M'
  Eigen::MatrixXd D;           ///< m x (p + 1), slack of the unconstrained minimiser; constant last
  Eigen::MatrixXd U;           ///< q x (p + 1)
  Eigen::MatrixXd V;           ///< q x m
  std::vector<double> domain;  ///< rows (a, b): a . t <= b, |a| = 1; the first 2 p are the box
  double rounding = 0.0;       ///< about what doubles lose in D, gram, U and V, relative
  bool linear = false;         ///< H = 0
  bool semidefinite = false;   ///< H is singular otherwise
  Eigen::MatrixXd cost;        ///< n x (p + 1), where H is singular
  Eigen::MatrixXd output;      ///< q x n, from z to u
  Eigen::MatrixXd curvature;   ///< n x n, a singular H, without what rounding adds to it
  bool domain_empty = false;   ///< a row without z can never hold

  // The reduced program in t, for starting points: min 1/2 z'Hz + (f + F t)'z, A z <= b + S t. A singular H
  // has something added to its diagonal.
  Eigen::MatrixXd H;
  Eigen::MatrixXd F;       ///< n x (p + 1), constant last
  Eigen::MatrixXd A;       ///< m x n
  Eigen::VectorXd length;  ///< m, of the rows of A in the norm of H^-1
  Eigen::MatrixXd S;       ///< m x (p + 1), constant last

  ParametricProgram source;  ///< what was reduced

  int domainCount() const { return static_cast<int>(domain.size()) / (p + 1); }
};

/// Throws Error when H has a negative eigenvalue there, or the equalities fix parameters.
NormalisedProgram normalise(const ParametricProgram& program);

}  // namespace polyfly
