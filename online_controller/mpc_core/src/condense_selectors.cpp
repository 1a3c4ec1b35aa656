#include "condense_parts.hpp"

namespace polyfly {
namespace {

/// Columns of the parameters by role.
struct Columns {
  Eigen::MatrixXd error, state, state_reference;  // nx x p
  Eigen::MatrixXd previous, input_reference;      // nu x p
  Eigen::MatrixXd reference;                      // ny x p
  Eigen::MatrixXd disturbance;                    // nd x p
};

Columns columnsOf(const MpcProblem& problem) {
  const auto p = static_cast<Eigen::Index>(problem.parameters.size());
  const Eigen::Index nx = problem.stateCount();
  const Eigen::Index nu = problem.inputCount();
  Columns columns;
  columns.error = columns.state = columns.state_reference = Eigen::MatrixXd::Zero(nx, p);
  columns.previous = columns.input_reference = Eigen::MatrixXd::Zero(nu, p);
  columns.reference = Eigen::MatrixXd::Zero(problem.C.rows(), p);
  columns.disturbance = Eigen::MatrixXd::Zero(problem.Bd_c.cols(), p);
  for (Eigen::Index j = 0; j < p; ++j) {
    const MpcProblem::Parameter& parameter = problem.parameters[static_cast<std::size_t>(j)];
    switch (parameter.role) {
      case ParameterRole::kError:
        columns.error(parameter.index, j) = 1.0;
        break;
      case ParameterRole::kPreviousInput:
        columns.previous(parameter.index, j) = 1.0;
        break;
      case ParameterRole::kInputReference:
        columns.input_reference(parameter.index, j) = 1.0;
        break;
      case ParameterRole::kStateReference:
        columns.state_reference(parameter.index, j) = 1.0;
        break;
      case ParameterRole::kState:
        columns.state(parameter.index, j) = 1.0;
        break;
      case ParameterRole::kReference:
        columns.reference(parameter.index, j) = 1.0;
        break;
      case ParameterRole::kDisturbance:
        columns.disturbance(parameter.index, j) = 1.0;
        break;
    }
  }
  return columns;
}

/// x_ref and u_ref as Eq. 6 has them for the columns of r and d.
void setSteadyState(const MpcProblem& problem, const WideModel& model, const Columns& columns,
                    Selectors* selectors) {
  selectors->state = WideMatrix::Zero(problem.stateCount(), columns.state.cols());
  selectors->reference = WideMatrix::Zero(problem.inputCount(), columns.state.cols());
  for (Eigen::Index j = 0; j < columns.state.cols(); ++j) {
    if (columns.disturbance.col(j).isZero(0.0) && columns.reference.col(j).isZero(0.0)) continue;
    const WideMatrix steady =
        wideSteadyState(model, problem.C, columns.disturbance.col(j), columns.reference.col(j));
    selectors->state.col(j) = steady.topRows(problem.stateCount());
    selectors->reference.col(j) = steady.bottomRows(problem.inputCount());
  }
}

}  // namespace

Selectors selectorsOf(const MpcProblem& problem, const WideModel& model) {
  const Columns columns = columnsOf(problem);
  const bool absolute = !columns.state.isZero(0.0);
  Selectors selectors;
  selectors.drift = WideMatrix::Zero(problem.stateCount(), columns.state.cols());
  if (absolute) {
    setSteadyState(problem, model, columns, &selectors);
    selectors.error = wide(columns.state) - selectors.state;
  } else {
    selectors.error = wide(columns.error);
    selectors.state = wide(columns.state_reference);
    selectors.reference = wide(columns.input_reference);
    if (columns.disturbance.rows() > 0) selectors.drift = model.Bd * wide(columns.disturbance);
  }
  // Without a previous input, u_{-1} := u_ref, so that the first change is u~_0 itself.
  const Eigen::Index nu = problem.inputCount();
  selectors.change = WideMatrix::Zero(nu, columns.state.cols());
  selectors.has_previous.assign(static_cast<std::size_t>(nu), 0);
  for (Eigen::Index i = 0; i < nu; ++i) {
    if (columns.previous.row(i).isZero(0.0)) continue;
    selectors.has_previous[static_cast<std::size_t>(i)] = 1;
    selectors.change.row(i) = wide(columns.previous.row(i)) - selectors.reference.row(i);
  }
  return selectors;
}

}  // namespace polyfly
