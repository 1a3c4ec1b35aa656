#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

struct ExactProgram;

/// Proves solutions of a strictly convex program at single parameters, in rational arithmetic: the last word
/// where an oracle in doubles and a map differ. One object serves one thread.
class ExactOptimalityCheck {
 public:
  /// `program` has passed checkProgram and outlives the arbiter. Nothing is computed before the first
  /// question.
  explicit ExactOptimalityCheck(const ParametricProgram& program) : program_(&program) {}

  /// Whether the solution with these rows active meets all conditions of optimality at theta, exactly; `u` is
  /// then the program's one output there, rounded. False also where the rows are dependent.
  bool optimal(const Eigen::VectorXd& theta, const std::vector<int>& active, Eigen::VectorXd& u);

 private:
  const ParametricProgram* program_;
  std::shared_ptr<const ExactProgram> exact_;
};

}  // namespace polyfly
