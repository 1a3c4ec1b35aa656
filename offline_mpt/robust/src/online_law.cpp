#include "robust_mpc/online_law.hpp"

namespace polyfly {

OnlineRobustLaw::OnlineRobustLaw(const RobustProblem& problem)
    : lp_(problem),
      theta_(Eigen::VectorXd::Zero(problem.parameterCount())),
      shift_(Eigen::VectorXd::Zero(problem.parameterCount())) {
  for (int j = 0; j < problem.parameterCount(); ++j) {
    const RobustProblem::Parameter& parameter = problem.parameters[static_cast<std::size_t>(j)];
    if (parameter.state < 0) shift_[j] = nearestDouble(parameter.input_shift[0]);
  }
}

std::optional<double> OnlineRobustLaw::input(const double* theta) {
  theta_ = Eigen::Map<const Eigen::VectorXd>(theta, theta_.size());
  const OnlineLp::Answer answer = lp_.solve(theta_);
  if (!answer.feasible) return std::nullopt;
  return answer.input + shift_.dot(theta_);
}

}  // namespace polyfly
