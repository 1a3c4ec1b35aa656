#include "random_program.hpp"

#include <random>
#include <string>

namespace polyfly {

ParametricProgram randomProgram(int n, int m, int p, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.2, 2.0);
  const auto gaussian = [&](int rows, int columns) {
    return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); }));
  };
  ParametricProgram program;
  program.name = "random_" + std::to_string(seed);
  program.text_kind = "json";
  const Eigen::MatrixXd root = gaussian(n, n);
  program.H = root * root.transpose() + 0.5 * Eigen::MatrixXd::Identity(n, n);
  program.f = gaussian(n, 1);
  program.F = gaussian(n, p);
  program.A = gaussian(m, n);
  program.b = Eigen::VectorXd::NullaryExpr(m, [&] { return uniform(random); });
  program.S = 0.3 * gaussian(m, p);
  for (int j = 0; j < p; ++j) program.parameters.push_back({"theta_" + std::to_string(j), "1", -1.0, 1.0});
  program.A_theta.resize(0, p);
  program.b_theta.resize(0);
  constexpr double kUnbounded = 1e300;
  program.inputs.push_back({"u_0", "1", -kUnbounded, kUnbounded});
  program.E = Eigen::MatrixXd::Identity(1, n);
  program.C = Eigen::MatrixXd::Zero(1, p);
  program.c = Eigen::VectorXd::Zero(1);
  return program;
}

void appendRow(ParametricProgram& program, const Eigen::VectorXd& a, double b, const Eigen::VectorXd& s) {
  const Eigen::Index m = program.A.rows();
  program.A.conservativeResize(m + 1, a.size());
  program.b.conservativeResize(m + 1);
  program.S.conservativeResize(m + 1, s.size());
  program.A.row(m) = a;
  program.b(m) = b;
  program.S.row(m) = s;
}

void appendMultiple(ParametricProgram& program, int row, double factor) {
  appendRow(program, factor * program.A.row(row), factor * program.b(row), factor * program.S.row(row));
}

void outputAllVariables(ParametricProgram& program) {
  const int n = program.variableCount();
  program.E = Eigen::MatrixXd::Identity(n, n);
  program.C = Eigen::MatrixXd::Zero(n, program.parameterCount());
  program.c = Eigen::VectorXd::Zero(n);
  program.inputs.assign(static_cast<std::size_t>(n), program.inputs.front());
  for (int i = 0; i < n; ++i) program.inputs[static_cast<std::size_t>(i)].name = "z_" + std::to_string(i);
}

}  // namespace polyfly
