#include "norm_cost_programs.hpp"

#include <Eigen/LU>
#include <string>

#include "random_program.hpp"

namespace polyfly {
namespace {

constexpr double kInputWeight = 0.3, kMostInput = 1.0, kMostState = 3.0;

/// |row (z, theta)| <= z_slack
void boundNorm(ParametricProgram& program, Eigen::VectorXd row, double weight, const Eigen::VectorXd& states,
               int slack) {
  row *= weight;
  row(slack) = -1.0;
  appendRow(program, row, 0.0, -weight * states);
  row *= -1.0;
  row(slack) = -1.0;
  appendRow(program, row, 0.0, weight * states);
}

/// |row (z, theta)| <= most
void boundSize(ParametricProgram& program, const Eigen::VectorXd& row, const Eigen::VectorXd& states,
               double most) {
  appendRow(program, row, most, -states);
  appendRow(program, -row, most, states);
}

}  // namespace

Plant integrators(int count, double period) {
  Plant plant{Eigen::MatrixXd::Identity(count, count), Eigen::VectorXd(count)};
  for (int i = 0; i < count; ++i) {
    double entry = 1.0;
    for (int j = i + 1; j <= count; ++j) {
      entry *= period / (j - i);
      if (j < count) plant.A(i, j) = entry;
    }
    plant.B(i) = entry;
  }
  return plant;
}

Plant oscillator(double period) {
  Eigen::Matrix2d rate;
  rate << 0.0, 1.0, -1.0, -0.1;
  const Eigen::Matrix2d step = (Eigen::Matrix2d::Identity() - period * rate).inverse();
  return {step, step * Eigen::Vector2d(0.0, period)};
}

ParametricProgram normCostMpc(const Plant& plant, CostNorm norm, int horizon) {
  const auto states = static_cast<int>(plant.A.rows());
  const bool one = norm == CostNorm::kOne;
  const int per_step = one ? states : 1, n = horizon * (2 + per_step);
  ParametricProgram program;
  program.name = "norm_cost_" + std::to_string(states) + (one ? "_1_N" : "_inf_N") + std::to_string(horizon);
  program.text_kind = "json";
  program.H = Eigen::MatrixXd::Zero(n, n);
  program.f = Eigen::VectorXd::Ones(n);
  program.f.head(horizon).setZero();
  program.F = Eigen::MatrixXd::Zero(n, states);
  program.A.resize(0, n);
  program.S.resize(0, states);
  for (int j = 0; j < states; ++j)
    program.parameters.push_back({"x_" + std::to_string(j), "1", -kMostState, kMostState});
  program.A_theta.resize(0, states);
  // x_k = from_x x_0 + from_z z
  Eigen::MatrixXd from_x = Eigen::MatrixXd::Identity(states, states),
                  from_z = Eigen::MatrixXd::Zero(states, n);
  int slack = horizon;
  for (int k = 0; k < horizon; ++k) {
    from_x = plant.A * from_x;
    from_z = plant.A * from_z;
    from_z.col(k) += plant.B;
    for (int j = 0; j < states; ++j) {
      boundNorm(program, from_z.row(j), 1.0, from_x.row(j), slack + (one ? j : 0));
      boundSize(program, from_z.row(j), from_x.row(j), kMostState);
    }
    slack += per_step;
  }
  for (int k = 0; k < horizon; ++k) {
    const Eigen::VectorXd input = Eigen::VectorXd::Unit(n, k), none = Eigen::VectorXd::Zero(states);
    boundNorm(program, input, kInputWeight, none, slack + k);
    boundSize(program, input, none, kMostInput);
  }
  program.inputs.push_back({"u", "1", -kMostInput, kMostInput});
  program.E = Eigen::MatrixXd::Identity(1, n);
  program.C = Eigen::MatrixXd::Zero(1, states);
  program.c = Eigen::VectorXd::Zero(1);
  return program;
}

}  // namespace polyfly
