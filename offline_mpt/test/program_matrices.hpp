#pragma once

#include <Eigen/Core>

#include "core/program.hpp"
#include "mpc_core/parametric_program.hpp"

namespace polyfly {

inline checker::Matrix exactMatrixOf(const Eigen::MatrixXd& values) {
  checker::Matrix result;
  result.rows = static_cast<std::size_t>(values.rows());
  result.columns = static_cast<std::size_t>(values.cols());
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    for (Eigen::Index j = 0; j < values.cols(); ++j) result.entries.emplace_back(values(i, j));
  }
  return result;
}

/// The numbers of a program as its certificate has them.
inline checker::Matrices matricesOf(const ParametricProgram& program) {
  Eigen::MatrixXd box(program.parameterCount(), 2);
  for (int j = 0; j < program.parameterCount(); ++j) {
    const Signal& parameter = program.parameters[static_cast<std::size_t>(j)];
    box.row(j) << parameter.lower, parameter.upper;
  }
  return {{"box", exactMatrixOf(box)},
          {"H", exactMatrixOf(program.H)},
          {"f", exactMatrixOf(program.f)},
          {"F", exactMatrixOf(program.F)},
          {"A", exactMatrixOf(program.A)},
          {"b", exactMatrixOf(program.b)},
          {"S", exactMatrixOf(program.S)},
          {"A_theta", exactMatrixOf(program.A_theta)},
          {"b_theta", exactMatrixOf(program.b_theta)},
          {"E", exactMatrixOf(program.E)},
          {"C", exactMatrixOf(program.C)},
          {"c", exactMatrixOf(program.c)}};
}

}  // namespace polyfly
