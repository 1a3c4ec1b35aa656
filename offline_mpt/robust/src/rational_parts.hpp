#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "polytope_sets/rational.hpp"

namespace polyfly {

/// An index of Eigen or of a row, as the standard containers take it.
inline std::size_t at(Eigen::Index index) { return static_cast<std::size_t>(index); }

/// Each number rounded to the nearest double.
inline Eigen::VectorXd toDoubles(const RationalVector& values) {
  return Eigen::Map<const Eigen::Matrix<Rational, Eigen::Dynamic, 1>>(values.data(), values.size())
      .unaryExpr(&nearestDouble);
}

}  // namespace polyfly
