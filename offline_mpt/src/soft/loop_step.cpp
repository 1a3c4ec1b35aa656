#include "soft/loop_step.hpp"

namespace polyfly {
namespace {

/// Rows of quantities over w = (theta, u, d, 1).
class Rows {
 public:
  explicit Rows(const MpcProblem& problem)
      : problem_(problem),
        p_(static_cast<Eigen::Index>(problem.parameters.size())),
        width_(p_ + problem.B_c.cols() + problem.Bd_c.cols() + 1) {}

  Eigen::MatrixXd zero(Eigen::Index rows) const { return Eigen::MatrixXd::Zero(rows, width_); }
  Eigen::MatrixXd input() const { return units(problem_.B_c.cols(), p_); }
  Eigen::MatrixXd disturbance() const { return units(problem_.Bd_c.cols(), p_ + problem_.B_c.cols()); }
  Eigen::RowVectorXd parameter(Eigen::Index j) const { return units(1, j); }

  /// The parameters of a role, 0 where there is none.
  Eigen::MatrixXd ofRole(ParameterRole role, Eigen::Index rows) const {
    Eigen::MatrixXd result = zero(rows);
    for (Eigen::Index j = 0; j < p_; ++j) {
      const MpcProblem::Parameter& parameter = problem_.parameters[static_cast<std::size_t>(j)];
      if (parameter.role == role) result(parameter.index, j) = 1.0;
    }
    for (const MpcProblem::Parameter& parameter : problem_.fixed_parameters)
      if (parameter.role == role) result(parameter.index, width_ - 1) = parameter.signal.lower;
    return result;
  }

 private:
  Eigen::MatrixXd units(Eigen::Index rows, Eigen::Index first) const {
    Eigen::MatrixXd result = zero(rows);
    result.middleCols(first, rows).setIdentity();
    return result;
  }

  const MpcProblem& problem_;
  Eigen::Index p_, width_;
};

/// References and states over w.
struct Motion {
  Eigen::MatrixXd x_ref, u_ref;
  Eigen::MatrixXd error, next_error;
};

Motion motionOfErrors(const MpcProblem& problem, const DiscreteModel& model, const Rows& rows) {
  Motion motion;
  motion.x_ref = rows.ofRole(ParameterRole::kStateReference, model.A.rows());
  motion.u_ref = rows.ofRole(ParameterRole::kInputReference, model.B.cols());
  motion.error = rows.ofRole(ParameterRole::kError, problem.stateCount());
  motion.next_error =
      model.A * motion.error + model.B * (rows.input() - motion.u_ref) + model.Bd * rows.disturbance();
  return motion;
}

Motion motionOfStates(const MpcProblem& problem, const DiscreteModel& model, const Rows& rows) {
  const Eigen::MatrixXd d = rows.ofRole(ParameterRole::kDisturbance, model.Bd.cols());
  const Eigen::MatrixXd r = rows.ofRole(ParameterRole::kReference, problem.C.rows());
  Motion motion{rows.zero(model.A.rows()), rows.zero(model.B.cols()), {}, {}};
  for (Eigen::Index j = 0; j < r.cols(); ++j) {
    if (d.col(j).isZero(0.0) && r.col(j).isZero(0.0)) continue;
    const SteadyState steady = steadyState(model, problem.C, d.col(j), r.col(j));
    motion.x_ref.col(j) = steady.x;
    motion.u_ref.col(j) = steady.u;
  }
  const Eigen::MatrixXd x = rows.ofRole(ParameterRole::kState, problem.stateCount());
  motion.error = x - motion.x_ref;
  motion.next_error = model.A * x + model.B * rows.input() + model.Bd * rows.disturbance() - motion.x_ref;
  return motion;
}

bool hasStates(const MpcProblem& problem) {
  for (const MpcProblem::Parameter& parameter : problem.parameters)
    if (parameter.role == ParameterRole::kState) return true;
  return false;
}

Eigen::MatrixXd successorOf(const MpcProblem& problem, const Motion& motion, const Rows& rows) {
  Eigen::MatrixXd successor = rows.zero(static_cast<Eigen::Index>(problem.parameters.size()));
  for (Eigen::Index j = 0; j < successor.rows(); ++j) {
    const MpcProblem::Parameter& parameter = problem.parameters[static_cast<std::size_t>(j)];
    switch (parameter.role) {
      case ParameterRole::kError:
        successor.row(j) = motion.next_error.row(parameter.index);
        break;
      case ParameterRole::kState:
        successor.row(j) = motion.next_error.row(parameter.index) + motion.x_ref.row(parameter.index);
        break;
      case ParameterRole::kPreviousInput:
        successor.row(j) = rows.input().row(parameter.index);
        break;
      case ParameterRole::kInputReference:
      case ParameterRole::kStateReference:
      case ParameterRole::kReference:
      case ParameterRole::kDisturbance:
        successor.row(j) = rows.parameter(j);
        break;
    }
  }
  return successor;
}

}  // namespace

std::string changingFixedParameter(const MpcProblem& problem) {
  for (const MpcProblem::Parameter& parameter : problem.fixed_parameters) {
    const bool changes = parameter.role == ParameterRole::kError || parameter.role == ParameterRole::kState ||
                         parameter.role == ParameterRole::kPreviousInput;
    if (changes) return parameter.signal.name;
  }
  return {};
}

LoopStep loopStep(const MpcProblem& problem) {
  const DiscreteModel model = discretise(problem, problem.sampling_time);
  const Rows rows(problem);
  const Motion motion =
      hasStates(problem) ? motionOfStates(problem, model, rows) : motionOfErrors(problem, model, rows);
  LoopStep step;
  step.successor = successorOf(problem, motion, rows);
  step.before = step.after = rows.zero(static_cast<Eigen::Index>(problem.constraints.size()));
  for (Eigen::Index i = 0; i < step.before.rows(); ++i) {
    const StageConstraint& constraint = problem.constraints[static_cast<std::size_t>(i)];
    const bool has_input = !constraint.G_u.isZero(0.0);
    Eigen::RowVectorXd held = constraint.G_u * (rows.input() - motion.u_ref);
    if (constraint.absolute) held += constraint.G_x * motion.x_ref + constraint.G_u * motion.u_ref;
    step.before.row(i) = constraint.G_x * motion.error + held;
    step.after.row(i) = constraint.G_x * (has_input ? motion.error : motion.next_error) + held;
  }
  return step;
}

}  // namespace polyfly
