#include "exact_programs.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "random_program.hpp"

namespace polyfly {

namespace {

/// |u| <= 1 and |x| <= 5 over the horizon, weights 1 and 0.1.
ParametricProgram controlled(const Eigen::Matrix2d& A, const Eigen::Vector2d& B, int horizon) {
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

}  // namespace

ParametricProgram doubleIntegrator(int horizon) {
  ParametricProgram program =
      controlled((Eigen::Matrix2d() << 1.0, 1.0, 0.0, 1.0).finished(), {0.5, 1.0}, horizon);
  program.name = "double_integrator_" + std::to_string(horizon);
  return program;
}

ParametricProgram unstableRotation(int horizon) {
  constexpr double kGrowth = 1.5, kAngle = 1.0471975511965976;
  const Eigen::Matrix2d A = kGrowth * Eigen::Rotation2Dd(kAngle).toRotationMatrix();
  ParametricProgram program = controlled(A, {0.0, 1.0}, horizon);
  program.name = "unstable_rotation_" + std::to_string(horizon);
  // Of the rows of states those of the last one stay, behind those of inputs.
  const ParametricProgram all = program;
  const int inputs = 2 * horizon;
  program.A.conservativeResize(inputs + 4, horizon);
  program.S.conservativeResize(inputs + 4, 2);
  program.b.conservativeResize(inputs + 4);
  for (const int side : {0, 1}) {
    const int from = (4 + 2 * side) * horizon - 2;
    program.A.middleRows<2>(inputs + 2 * side) = all.A.middleRows<2>(from);
    program.S.middleRows<2>(inputs + 2 * side) = all.S.middleRows<2>(from);
  }
  program.b.tail<4>().setConstant(0.5);
  for (Signal& parameter : program.parameters) {
    parameter.lower = -1.5;
    parameter.upper = 1.5;
  }
  return program;
}

ParametricProgram nearlyDependent(double distance, unsigned seed) {
  ParametricProgram program = randomProgram(5, 12, 3, seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 6; i < 12; ++i) {
    program.A.row(i) = uniform(random) * program.A.row(i - 6) + uniform(random) * program.A.row((i - 5) % 6);
    for (int j = 0; j < 5; ++j) program.A(i, j) += distance * uniform(random);
  }
  return program;
}

ParametricProgram nearlyMeeting(int n, int p, double distance, unsigned seed) {
  ParametricProgram program = randomProgram(n, n + 3, p, seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Eigen::VectorXd theta = Eigen::VectorXd::NullaryExpr(p, [&] { return 0.6 * uniform(random) - 0.3; });
  const Eigen::VectorXd z = -program.H.ldlt().solve(program.f + program.F * theta);
  program.b = program.A * z - program.S * theta;
  for (int i = 0; i < n + 3; ++i) program.b(i) += distance * uniform(random);
  return program;
}

void withoutBounds(ParametricProgram& program) {
  for (Signal& input : program.inputs) {
    input.upper = std::numeric_limits<double>::infinity();
    input.lower = -input.upper;
  }
}

ParametricProgram illConditioned(int n, int m, int p, unsigned seed) {
  ParametricProgram program = randomProgram(n, m + 2 * n, p, seed);
  const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(program.H).householderQ();
  Eigen::VectorXd values(n);
  for (int i = 0; i < n; ++i) values(i) = std::pow(10.0, -6.0 + 6.0 * i / (n - 1));
  program.H = Q * values.asDiagonal() * Q.transpose();
  program.H = (0.5 * (program.H + program.H.transpose())).eval();
  program.A.bottomRows(2 * n) << Eigen::MatrixXd::Identity(n, n), -Eigen::MatrixXd::Identity(n, n);
  program.b.tail(2 * n).setConstant(2.0);
  program.S.bottomRows(2 * n).setZero();
  outputAllVariables(program);
  withoutBounds(program);
  return program;
}

ParametricProgram touching(unsigned seed) {
  ParametricProgram program = randomProgram(3, 10, 2, seed);
  const Eigen::LDLT<Eigen::MatrixXd> H(program.H);
  program.b(9) = -program.A.row(9).dot(H.solve(program.f));
  program.S.row(9) = -program.A.row(9) * H.solve(program.F);
  return program;
}

ParametricProgram redundantEqualities(unsigned seed, bool whole) {
  ParametricProgram program = randomProgram(5, 12, 2, seed);
  for (const int row : {0, 1}) {
    if (whole) {
      program.A.row(row) = (4.0 * program.A.row(row)).array().round();
      program.S.row(row) = (8.0 * program.S.row(row)).array().round() / 4.0;
    }
    program.b(row) *= 0.1;
  }
  const double weights[2][2] = {{whole ? 3.0 : 0.3, 1.0}, {-1.0, whole ? 2.0 : 0.7}};
  for (const int k : {0, 1}) {
    program.A.row(2 + k) = weights[k][0] * program.A.row(0) + weights[k][1] * program.A.row(1);
    program.S.row(2 + k) = weights[k][0] * program.S.row(0) + weights[k][1] * program.S.row(1);
    program.b(2 + k) = weights[k][0] * program.b(0) + weights[k][1] * program.b(1);
  }
  program.equalities = {0, 1, 2, 3};
  return program;
}

ParametricProgram smallLinearProgram() {
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

ParametricProgram normControl(int horizon) {
  const ParametricProgram bounds = doubleIntegrator(horizon);
  const int k = horizon, n = 4 * k;
  const Eigen::MatrixXd responses = bounds.A.middleRows(2 * k, 2 * k);
  ParametricProgram program = bounds;
  program.name = "norm_control_" + std::to_string(horizon);
  program.H = Eigen::MatrixXd::Zero(n, n);
  program.f = Eigen::VectorXd::Ones(n);
  program.f.head(k).setZero();
  program.F = Eigen::MatrixXd::Zero(n, 2);
  program.A = Eigen::MatrixXd::Zero(12 * k, n);
  program.A.topLeftCorner(6 * k, k) = bounds.A;
  program.A.block(6 * k, 0, 4 * k, k) << responses, -responses;
  program.A.block(10 * k, 0, 2 * k, k) << 0.5 * Eigen::MatrixXd::Identity(k, k),
      -0.5 * Eigen::MatrixXd::Identity(k, k);
  for (const int sign : {0, 1}) {
    program.A.block((6 + 2 * sign) * k, k, 2 * k, 2 * k) = -Eigen::MatrixXd::Identity(2 * k, 2 * k);
    program.A.block((10 + sign) * k, 3 * k, k, k) = -Eigen::MatrixXd::Identity(k, k);
  }
  program.b = Eigen::VectorXd::Zero(12 * k);
  program.b.head(6 * k) = bounds.b;
  program.S = Eigen::MatrixXd::Zero(12 * k, 2);
  program.S.topRows(6 * k) = bounds.S;
  program.S.middleRows(6 * k, 4 * k) = bounds.S.bottomRows(4 * k);
  program.E = Eigen::MatrixXd::Identity(1, n);
  return program;
}

}  // namespace polyfly
