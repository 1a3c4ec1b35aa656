#pragma once

#include <Eigen/Core>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

enum class CostNorm { kOne, kInfinity };

/// x+ = A x + B u with one input.
struct Plant {
  Eigen::MatrixXd A;
  Eigen::VectorXd B;
};

/// A chain of so many integrators, sampled exactly.
Plant integrators(int count, double period);

/// A damped oscillator of frequency 1 rad/s, by Euler's backward rule.
Plant oscillator(double period);

/// min sum |x_k| + |0.3 u_k| over k with |u_k| <= 1, |x_k| <= 3, and x_0 the parameter: a linear program.
ParametricProgram normCostMpc(const Plant& plant, CostNorm norm, int horizon);

}  // namespace polyfly
