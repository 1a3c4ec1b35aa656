#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <limits>
#include <random>
#include <string>

#include "mpc_core/parametric_program.hpp"
#include "random_program.hpp"

namespace polyfly {

/// A double integrator with bounds on input and both states, condensed: its feasible set has edges inside the
/// box, and rows become dependent on them.
inline ParametricProgram doubleIntegrator(int horizon) {
  Eigen::Matrix2d A;
  A << 1.0, 1.0, 0.0, 1.0;
  const Eigen::Vector2d B(0.5, 1.0);
  const int n = horizon;
  Eigen::MatrixXd powers = Eigen::MatrixXd::Zero(2 * n, 2);     // states from theta
  Eigen::MatrixXd responses = Eigen::MatrixXd::Zero(2 * n, n);  // states from inputs
  Eigen::Matrix2d power = Eigen::Matrix2d::Identity();
  for (int k = 0; k < n; ++k) {
    for (int j = k; j < n; ++j) responses.block<2, 1>(2 * j, j - k) = power * B;
    power = A * power;
    powers.block<2, 2>(2 * k, 0) = power;
  }
  ParametricProgram program;
  program.name = "double_integrator_" + std::to_string(horizon);
  program.text_kind = "json";
  program.H = responses.transpose() * responses + 0.1 * Eigen::MatrixXd::Identity(n, n);
  program.H = (0.5 * (program.H + program.H.transpose())).eval();
  program.f = Eigen::VectorXd::Zero(n);
  program.F = responses.transpose() * powers;
  program.A.resize(6 * n, n);
  program.A << Eigen::MatrixXd::Identity(n, n), -Eigen::MatrixXd::Identity(n, n), responses, -responses;
  program.S = Eigen::MatrixXd::Zero(6 * n, 2);
  program.S.middleRows(2 * n, 2 * n) = -powers;
  program.S.bottomRows(2 * n) = powers;
  program.b = Eigen::VectorXd::Constant(6 * n, 5.0);
  program.b.head(2 * n).setOnes();
  program.parameters = {{"p", "m", -8.0, 8.0}, {"v", "m/s", -6.0, 6.0}};
  program.A_theta.resize(0, 2);
  program.b_theta.resize(0);
  const double unbounded = std::numeric_limits<double>::infinity();
  program.inputs = {{"u", "m/s^2", -unbounded, unbounded}};
  program.E = Eigen::MatrixXd::Identity(1, n);
  program.C = Eigen::MatrixXd::Zero(1, 2);
  program.c = Eigen::VectorXd::Zero(1);
  return program;
}

/// Rows that depend on others but for `distance`.
inline ParametricProgram nearlyDependent(double distance, unsigned seed) {
  ParametricProgram program = randomProgram(5, 12, 3, seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 6; i < 12; ++i) {
    program.A.row(i) = uniform(random) * program.A.row(i - 6) + uniform(random) * program.A.row((i - 5) % 6);
    for (int j = 0; j < 5; ++j) program.A(i, j) += distance * uniform(random);
  }
  return program;
}

/// Its last row touches the unconstrained minimiser everywhere, up to rounding.
inline ParametricProgram touching(unsigned seed) {
  ParametricProgram program = randomProgram(3, 10, 2, seed);
  const Eigen::LDLT<Eigen::MatrixXd> H(program.H);
  program.b(9) = -program.A.row(9).dot(H.solve(program.f));
  program.S.row(9) = -program.A.row(9) * H.solve(program.F);
  return program;
}

/// min |z|_1-like linear program: H = 0, with prices, ties and a cost that does not depend on theta.
inline ParametricProgram smallLinearProgram() {
  ParametricProgram program = randomProgram(2, 5, 2, 1);
  program.name = "small_linear";
  program.H.setZero();
  program.F.setZero();
  program.f << 1.0, 1.0;
  program.A << -1.0, 0.0, 0.0, -1.0, -1.0, -1.0, -1.0, -2.0, 1.0, 1.0;
  program.b << 1.0, 1.0, 1.0, 1.5, 10.0;
  program.S << 1.0, 0.0, 0.0, 1.0, 1.0, 0.5, -0.25, 1.0, 0.0, 0.0;
  return program;
}

}  // namespace polyfly
