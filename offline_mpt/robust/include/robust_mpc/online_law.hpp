#pragma once

#include <optional>

#include "robust_mpc/online_lp.hpp"
#include "robust_mpc/robust_problem.hpp"

namespace polyfly {

/// The first input u_0 of a robust problem, solved at each theta by OnlineLp in floating point.
class OnlineRobustLaw {
 public:
  explicit OnlineRobustLaw(const RobustProblem& problem);

  /// theta in the order of the problem's parameters; none where no plan meets all bounds.
  std::optional<double> input(const double* theta);

 private:
  OnlineLp lp_;
  Eigen::VectorXd theta_;
  // Shift of the input by each parameter. Only references shift it.
  Eigen::VectorXd shift_;
};

}  // namespace polyfly
