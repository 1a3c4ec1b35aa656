#pragma once

#include <vector>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// A program in units in which its numbers are of order one. All factors are powers of two, so nothing is rounded.
struct ScaledProgram {
  /// Rows, cost, variables and outputs are scaled; parameters are not.
  ParametricProgram program;
  /// Variable j of the source is 2^variables[j] times that of `program`.
  std::vector<int> variables;
  /// Output i of the source is 2^outputs[i] times that of `program`.
  std::vector<int> outputs;
  /// The cost of `program` is 2^cost times that of the source.
  int cost = 0;
};

/// Units in which `program` does not depend on those of its file: each variable is measured by the size that the rows and the
/// box of parameters give it. Where that would lose curvatures of a positive definite H beside others, as with rows whose
/// entries decay along a horizon, H gets a diagonal of about 1 instead.
ScaledProgram scaleProgram(const ParametricProgram& program);

}  // namespace polyfly
