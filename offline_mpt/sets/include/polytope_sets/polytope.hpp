#pragma once

#include <Eigen/Core>
#include <vector>

#include "polytope_sets/exact_polytope.hpp"

namespace polyfly {

/// {x : A x <= b} in floating point, rows of length 1, bounded, in 1 to 13 dimensions. Quick, and right up to
/// tolerances that are named below; ExactPolytope answers without any.
struct Polytope {
  Eigen::MatrixXd A;  ///< rows x dimension
  Eigen::VectorXd b;

  int dimension() const { return static_cast<int>(A.cols()); }
  int rowCount() const { return static_cast<int>(A.rows()); }
};

/// Rounds, equalities as two rows, and gives rows length 1; rows 0 . x <= b are dropped, or become
/// two rows that contradict each other where b < 0.
Polytope rounded(const ExactPolytope& set);

/// The same doubles as fractions.
ExactPolytope exactly(const Polytope& set);

/// Largest ball inside. A radius below 0 says that the set is empty, and by how much; a set without interior
/// has a radius of about 0. Throws Error when the set is unbounded or the simplex method fails.
struct Ball {
  Eigen::VectorXd centre;
  double radius = 0.0;
};
Ball chebyshevBall(const Polytope& set);

/// max direction . x over a set that holds a ball; `inside` is a point of its interior. Throws Error when the
/// simplex method fails.
double support(const Polytope& set, const Eigen::VectorXd& inside, const Eigen::VectorXd& direction);

/// Without the rows that no point breaks by more than `tolerance` while all others hold. The set must have
/// interior. Throws Error when it has not.
Polytope minimal(const Polytope& set, double tolerance);

/// The set of all but coordinate `column` (from 0): Fourier and Motzkin's elimination, then `minimal`.
Polytope eliminate(const Polytope& set, int column, double tolerance);

}  // namespace polyfly
