#pragma once

#include <vector>

#include "arithmetic/exact_matrix.hpp"
#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// An entry of the program that counts as another number, which differs from it by rounding only.
struct ReplacedEntry {
  enum class Matrix { kH, kF, kf, kA };
  Matrix matrix;
  int row = 0;
  int column = 0;
  Rational value;
};

/// H is singular where `basis`, rows that hold with equality, leaves z free; H not zero.
bool isSingular(const ParametricProgram& program, const std::vector<int>& basis);

/// Rounding gives a singular H small eigenvalues of either sign, and costs and rows small parts along its
/// null space, which would decide the optimum. These entries make up a program where H is positive
/// semidefinite of its rank without rounding, and where costs and rows lie in the range of H that do so up to
/// rounding; none, where the program is so already. `penalty` times A_e'A_e over the basis is added to H,
/// which changes nothing where the basis holds.
std::vector<ReplacedEntry> withoutRounding(const ParametricProgram& program, const std::vector<int>& basis,
                                           double& penalty);

}  // namespace polyfly
