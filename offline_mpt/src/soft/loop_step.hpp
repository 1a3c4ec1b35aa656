#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"

namespace polyfly {

/// One sampling time of the closed loop of a tracking problem, as affine functions of w = (theta, u, d, 1). References
/// and the parameters of role `disturbance` are held; d is the disturbance that acts.
struct LoopStep {
  Eigen::MatrixXd successor;  ///< p x w, the next theta
  /// The sum that each constraint bounds, constraints x w. One with an input is that of the stage before the step in both.
  Eigen::MatrixXd before, after;
};

/// Name of a fixed parameter that changes with the loop, so that no theta describes what follows; empty: none.
std::string changingFixedParameter(const MpcProblem& problem);

/// Needs changingFixedParameter to be empty.
LoopStep loopStep(const MpcProblem& problem);

}  // namespace polyfly
