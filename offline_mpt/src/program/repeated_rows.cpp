#include "program/repeated_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace polyfly {

RepeatedRows::RepeatedRows(const ParametricProgram& program)
    : n_(program.variableCount()), columns_(n_ + program.parameterCount() + 1, program.rowCount()) {
  const Eigen::Index p = program.parameterCount();
  for (Eigen::Index i = 0; i < columns_.cols(); ++i) {
    auto column = columns_.col(i);
    column.head(n_) = program.A.row(i);
    column(n_ + p) = program.b(i);
    for (Eigen::Index j = 0; j < p; ++j) {
      const Signal& signal = program.parameters[static_cast<std::size_t>(j)];
      column(n_ + j) = program.S(i, j) * 0.5 * (signal.upper - signal.lower);
      column(n_ + p) += program.S(i, j) * 0.5 * (signal.upper + signal.lower);
    }
    const double largest = column.head(n_).cwiseAbs().maxCoeff();
    column *= largest > 0.0 ? 1.0 / largest : 0.0;
  }
}

double RepeatedRows::distance(int i, int k) const {
  const auto row = columns_.col(i), other = columns_.col(k);
  if (row.isZero(0.0) || other.isZero(0.0)) return std::numeric_limits<double>::infinity();
  const double normals = (row - other).head(n_).cwiseAbs().maxCoeff();
  const double bounds = (row - other).tail(row.size() - n_).cwiseAbs().sum();
  return std::max(normals, bounds / (1.0 + other.tail(other.size() - n_).cwiseAbs().maxCoeff()));
}

}  // namespace polyfly
