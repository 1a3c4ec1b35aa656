#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "polytope_sets/rational.hpp"

namespace polyfly {

/// An index of Eigen or of a row, as the standard containers take it.
inline std::size_t at(Eigen::Index index) { return static_cast<std::size_t>(index); }

/// Each entry rounded to the nearest double.
inline Eigen::MatrixXd toDoubles(const RationalMatrix& matrix) {
  Eigen::MatrixXd result(matrix.rows(), matrix.columns());
  for (int i = 0; i < matrix.rows(); ++i) {
    for (int j = 0; j < matrix.columns(); ++j) result(i, j) = nearestDouble(matrix(i, j));
  }
  return result;
}

}  // namespace polyfly
