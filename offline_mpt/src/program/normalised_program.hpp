#pragma once

#include <Eigen/Core>
#include <vector>

#include "lp/polytope.hpp"
#include "mpc_core/identity_form.hpp"
#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// A parametric program brought to the form in which it is explored.
///
/// Rows, cost, z and u are in the units of scaleProgram. Parameters are scaled, theta = centre + half .* t with t in [-1, 1]^p; equalities are eliminated; rows
/// that repeat or are implied by a parallel row are dropped; rows have unit length in the norm of H^-1. With
/// multipliers lambda of the rows left,
///
///     slack(t) = D (t, 1) + gram lambda,   u(t) = U (t, 1) + V lambda.
///
/// A linear program (H = 0) is the limit of H = eps I for eps -> 0, taken symbolically: of all optima the one
/// of least length |z| is chosen, which is unique and, where the cost does not depend on theta, continuous.
/// Multipliers are then cost multipliers / eps + lambda with cost + M' cost multipliers = 0, and all of the
/// above holds with the lambda of order one.
struct NormalisedProgram {
  /// Number of parameters.
  int p = 0;
  /// Number of variables left.
  int n = 0;
  /// Number of rows left.
  int m = 0;
  Eigen::VectorXd centre;  ///< p
  Eigen::VectorXd half;    ///< p
  /// Rows of the program.
  std::vector<int> row_ids;  ///< m
  /// Unit rows A L^-T with H = L L'.
  Eigen::MatrixXd M;  ///< m x n
  /// Gram matrix M M'.
  Eigen::MatrixXd gram;  ///< m x m
  /// Slack of the unconstrained minimiser, constant last.
  Eigen::MatrixXd D;  ///< m x (p + 1)
  Eigen::MatrixXd U;  ///< q x (p + 1)
  Eigen::MatrixXd V;  ///< q x m
  /// Rows (a, b): a . t <= b, |a| = 1. The first 2 p are the box.
  std::vector<double> domain;
  /// Approximate relative rounding error of D, gram, U and V.
  double rounding = 0.0;
  bool linear = false;  ///< H = 0
  /// The cost, where H is zero.
  Eigen::MatrixXd cost;  ///< n x (p + 1)
  /// A row without z can never hold.
  bool domain_empty = false;

  // The reduced program in t: A z <= S (t, 1).
  Eigen::MatrixXd A;  ///< m x n
  /// Lengths of the rows of A in the norm of H^-1.
  Eigen::VectorXd length;  ///< m
  Eigen::MatrixXd S;       ///< m x (p + 1), constant last

  /// The program before the reduction, scaled.
  ParametricProgram source;
  /// ScaledProgram::outputs: u of the program as it was given is 2^outputs times u.
  std::vector<int> outputs;  ///< q

  /// Whether the cost of z does not depend on the parameters. H is zero.
  bool constantCost() const { return cost.leftCols(p).isZero(0.0); }
  int domainCount() const { return static_cast<int>(domain.size()) / (p + 1); }
};

/// Parameters of a program that is explored, at most. Depths of cells take one dimension more.
constexpr int kMostParameters = PolytopeSolver::kMaxDimension - 1;

/// Throws Error when there are more than kMostParameters, H is neither zero nor positive definite where the equalities
/// leave z free, or the equalities fix parameters.
NormalisedProgram normalise(const ParametricProgram& program);

/// A program without equalities, in t.
AffineProgram affineInBox(const ParametricProgram& program);

}  // namespace polyfly
