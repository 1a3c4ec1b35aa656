#pragma once

#include <Eigen/Core>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// The rows of a program in units in which those that say the same are equal.
class RepeatedRows {
 public:
  explicit RepeatedRows(const ParametricProgram& program);

  /// Greatest difference of two rows where |z_j| <= 1, relative to their greatest entries of A; bounds differ
  /// anywhere in the box relative to 1 + |bound|. Infinite where a row of A is zero.
  double distance(int i, int k) const;

 private:
  Eigen::Index n_;
  /// Columns (A, S half, b + S centre), divided by the greatest entry of A.
  Eigen::MatrixXd columns_;
};

}  // namespace polyfly
