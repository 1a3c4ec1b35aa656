#pragma once

#include <Eigen/Core>
#include <string>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// Linear MPC of unit masses in a row between two walls, with unit springs and a force on the first. Sampled at 0.5 s, costs
/// 100 |x|^2 + u^2, |u| <= 0.5, positions within 4 at all but the last step, states from -4 to 4. Its laws are very steep.
inline ParametricProgram springChain(int masses, int horizon) {
  const int n = 2 * masses, N = horizon;
  constexpr double kPeriod = 0.5, kStateCost = 100.0, kForce = 0.5, kReach = 4.0;
  Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(n + 1, n + 1);
  for (int i = 0; i < masses; ++i) {
    rates(i, masses + i) = 1.0;
    rates(masses + i, i) = -2.0;
    if (i > 0) rates(masses + i, i - 1) = 1.0;
    if (i + 1 < masses) rates(masses + i, i + 1) = 1.0;
  }
  rates(masses, n) = 1.0;
  // The exponential as a series.
  Eigen::MatrixXd step = Eigen::MatrixXd::Identity(n + 1, n + 1), term = step;
  for (int k = 1; k < 30; ++k) {
    term = (term * rates * (kPeriod / k)).eval();
    step += term;
  }
  const Eigen::MatrixXd A = step.topLeftCorner(n, n), B = step.topRightCorner(n, 1);

  ParametricProgram program;
  program.name = "spring_chain_" + std::to_string(n) + "_N" + std::to_string(N);
  program.text_kind = "json";
  program.H = Eigen::MatrixXd::Identity(N, N);
  program.F = Eigen::MatrixXd::Zero(N, n);
  program.f = Eigen::VectorXd::Zero(N);
  program.A.resize(2 * N + 2 * masses * (N - 1), N);
  program.A.topRows(2 * N) << Eigen::MatrixXd::Identity(N, N), -Eigen::MatrixXd::Identity(N, N);
  program.S = Eigen::MatrixXd::Zero(program.A.rows(), n);
  program.b = Eigen::VectorXd::Constant(program.A.rows(), kReach);
  program.b.head(2 * N).setConstant(kForce);
  Eigen::MatrixXd free = Eigen::MatrixXd::Identity(n, n), forced = Eigen::MatrixXd::Zero(n, N);
  for (int k = 0; k < N; ++k) {
    forced = (A * forced).eval();
    forced.col(k) += B;
    free = (A * free).eval();
    program.H += kStateCost * forced.transpose() * forced;
    program.F += kStateCost * forced.transpose() * free;
    if (k + 1 == N) break;
    const int first = 2 * N + 2 * masses * k;
    program.A.middleRows(first, masses) = forced.topRows(masses);
    program.A.middleRows(first + masses, masses) = -forced.topRows(masses);
    program.S.middleRows(first, masses) = -free.topRows(masses);
    program.S.middleRows(first + masses, masses) = free.topRows(masses);
  }
  program.H = (0.5 * (program.H + program.H.transpose())).eval();
  for (int i = 0; i < n; ++i) program.parameters.push_back({"x" + std::to_string(i), "1", -kReach, kReach});
  program.A_theta.resize(0, n);
  program.b_theta.resize(0);
  program.inputs.push_back({"u", "1", -kForce, kForce});
  program.E = Eigen::MatrixXd::Identity(1, N);
  program.C = Eigen::MatrixXd::Zero(1, n);
  program.c = Eigen::VectorXd::Zero(1);
  return program;
}

}  // namespace polyfly
