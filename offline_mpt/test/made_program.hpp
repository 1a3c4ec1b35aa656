#pragma once

#include <string>

#include "mpc_core/parametric_program.hpp"
#include "random.hpp"

namespace polyfly {

struct ProgramSize {
  int variables = 2;
  int rows = 6;
  int parameters = 2;
};

/// A strictly convex program whose parameters range over [-1, 1]; z = 0 is feasible at theta = 0. The output
/// is z.
inline ParametricProgram madeProgram(std::uint64_t seed, const ProgramSize& size) {
  Random random(seed);
  const int n = size.variables, m = size.rows, p = size.parameters;
  ParametricProgram program;
  program.name = "made_" + std::to_string(seed);
  program.text_kind = "json";
  const Eigen::MatrixXd L = random.matrix(n, n);
  program.H = L * L.transpose() + 0.5 * Eigen::MatrixXd::Identity(n, n);
  program.f = Eigen::VectorXd::Zero(n);
  program.F = 2.0 * random.matrix(n, p);
  program.A = random.matrix(m, n);
  program.b = Eigen::VectorXd::Constant(m, 0.2) + 0.4 * random.matrix(m, 1).cwiseAbs();
  program.S = 0.3 * random.matrix(m, p);
  for (int i = 0; i < p; ++i) program.parameters.push_back({"t" + std::to_string(i), "1", -1.0, 1.0});
  program.A_theta.resize(0, p);
  program.b_theta.resize(0);
  for (int i = 0; i < n; ++i) program.inputs.push_back({"z" + std::to_string(i), "1", -1e3, 1e3});
  program.E = Eigen::MatrixXd::Identity(n, n);
  program.C = Eigen::MatrixXd::Zero(n, p);
  program.c = Eigen::VectorXd::Zero(n);
  return program;
}

}  // namespace polyfly
