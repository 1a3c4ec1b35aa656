#include <Eigen/Core>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kZeroRow =
    1e-13;  // a state row below this, relative to its parameter part, does not depend on z

/// Which entries of theta are the error, the previous input and the input reference.
struct Selectors {
  Eigen::MatrixXd error;      ///< e_0 = error theta, nx x p
  Eigen::MatrixXd reference;  ///< u_ref = reference theta, nu x p
  Eigen::MatrixXd change;     ///< u_{-1} - u_ref = change theta, nu x p
};

Selectors select(const MpcProblem& problem) {
  const auto p = static_cast<Eigen::Index>(problem.parameters.size());
  const Eigen::Index nx = problem.stateCount();
  const Eigen::Index nu = problem.inputCount();
  Selectors selectors;
  selectors.error = Eigen::MatrixXd::Zero(nx, p);
  selectors.reference = Eigen::MatrixXd::Zero(nu, p);
  Eigen::MatrixXd previous = Eigen::MatrixXd::Zero(nu, p);
  std::vector<bool> has_previous(static_cast<std::size_t>(nu), false);
  for (Eigen::Index j = 0; j < p; ++j) {
    const MpcProblem::Parameter& parameter = problem.parameters[static_cast<std::size_t>(j)];
    switch (parameter.role) {
      case ParameterRole::kError:
        selectors.error(parameter.index, j) = 1.0;
        break;
      case ParameterRole::kPreviousInput:
        previous(parameter.index, j) = 1.0;
        has_previous[static_cast<std::size_t>(parameter.index)] = true;
        break;
      case ParameterRole::kInputReference:
        selectors.reference(parameter.index, j) = 1.0;
        break;
    }
  }
  // Without a previous input, u_{-1} := u_ref, so that the first change is u~_0 itself.
  selectors.change = Eigen::MatrixXd::Zero(nu, p);
  for (Eigen::Index i = 0; i < nu; ++i) {
    if (has_previous[static_cast<std::size_t>(i)]) {
      selectors.change.row(i) = previous.row(i) - selectors.reference.row(i);
    }
  }
  return selectors;
}

/// e_k = state[k-1] e_0 + input[k-1] z, k = 1..N.
struct Prediction {
  std::vector<Eigen::MatrixXd> state;
  std::vector<Eigen::MatrixXd> input;
};

Prediction predict(const DiscreteModel& model, int horizon) {
  const Eigen::Index nx = model.A.rows();
  const Eigen::Index nu = model.B.cols();
  Prediction prediction;
  Eigen::MatrixXd state = Eigen::MatrixXd::Identity(nx, nx);
  Eigen::MatrixXd input = Eigen::MatrixXd::Zero(nx, horizon * nu);
  for (int k = 0; k < horizon; ++k) {
    state = (model.A * state).eval();
    input = (model.A * input).eval();
    input.middleCols(k * nu, nu) = model.B;
    prediction.state.push_back(state);
    prediction.input.push_back(input);
  }
  return prediction;
}

/// 1/2 z'Hz + (F theta)'z equals Eq. 4 but for terms without z; hence the factors 2.
void setCost(const MpcProblem& problem, const DiscreteModel& model, const Prediction& prediction,
             const Selectors& selectors, ParametricProgram* program) {
  const int N = problem.horizon;
  const Eigen::Index nu = problem.inputCount();
  const Eigen::Index n = N * nu;
  const Eigen::MatrixXd P = solveRiccati(model.A, model.B, problem.Q, problem.R);
  program->H = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd F_error = Eigen::MatrixXd::Zero(n, problem.stateCount());
  for (int k = 0; k < N; ++k) {
    const Eigen::MatrixXd weighted =
        (k + 1 < N ? problem.Q : P) * prediction.input[static_cast<std::size_t>(k)];
    program->H.noalias() += 2.0 * prediction.input[static_cast<std::size_t>(k)].transpose() * weighted;
    F_error.noalias() += 2.0 * weighted.transpose() * prediction.state[static_cast<std::size_t>(k)];
  }
  for (int k = 0; k < N; ++k) {
    const Eigen::Index i = k * nu;
    program->H.block(i, i, nu, nu) += 2.0 * (problem.R + problem.R_delta);
    if (k + 1 == N) continue;
    program->H.block(i, i, nu, nu) += 2.0 * problem.R_delta;
    program->H.block(i, i + nu, nu, nu) -= 2.0 * problem.R_delta;
    program->H.block(i + nu, i, nu, nu) -= 2.0 * problem.R_delta;
  }
  program->H = (0.5 * (program->H + program->H.transpose())).eval();
  program->f = Eigen::VectorXd::Zero(n);
  program->F = F_error * selectors.error;
  program->F.topRows(nu) -= 2.0 * problem.R_delta * selectors.change;
}

/// Collects rows A z <= b + S theta; those without z become A_theta theta <= b_theta.
class Rows {
 public:
  void add(const Eigen::RowVectorXd& on_z, double bound, const Eigen::RowVectorXd& on_theta,
           std::string name) {
    if (!std::isfinite(bound)) return;
    const bool without_z = on_z.cwiseAbs().maxCoeff() <= kZeroRow * on_theta.cwiseAbs().maxCoeff();
    (without_z ? parameter_rows_ : rows_).push_back({on_z, on_theta, bound, std::move(name)});
  }

  void store(ParametricProgram* program, Eigen::Index n, Eigen::Index p) const {
    const auto m = static_cast<Eigen::Index>(rows_.size());
    program->A.resize(m, n);
    program->b.resize(m);
    program->S.resize(m, p);
    for (Eigen::Index i = 0; i < m; ++i) {
      const Row& row = rows_[static_cast<std::size_t>(i)];
      program->A.row(i) = row.on_z;
      program->b(i) = row.bound;
      program->S.row(i) = row.on_theta;
      program->row_names.push_back(row.name);
    }
    const auto k = static_cast<Eigen::Index>(parameter_rows_.size());
    program->A_theta.resize(k, p);
    program->b_theta.resize(k);
    for (Eigen::Index i = 0; i < k; ++i) {
      const Row& row = parameter_rows_[static_cast<std::size_t>(i)];
      program->A_theta.row(i) = -row.on_theta;
      program->b_theta(i) = row.bound;
    }
  }

 private:
  struct Row {
    Eigen::RowVectorXd on_z, on_theta;
    double bound = 0.0;
    std::string name;
  };
  std::vector<Row> rows_, parameter_rows_;
};

std::string rowName(const std::string& subject, double sign, int step) {
  return subject + (sign > 0.0 ? " at its upper bound" : " at its lower bound") + ", step " +
         std::to_string(step);
}

void setRows(const MpcProblem& problem, const Prediction& prediction, const Selectors& selectors,
             ParametricProgram* program) {
  const Eigen::Index nu = problem.inputCount();
  const Eigen::Index n = problem.horizon * nu;
  const auto p = static_cast<Eigen::Index>(problem.parameters.size());
  Rows rows;
  for (const double sign : {1.0, -1.0}) {  // upper bounds first, then lower ones
    for (Eigen::Index i = 0; i < n; ++i) {
      const Signal& input = problem.inputs[static_cast<std::size_t>(i % nu)];
      const Eigen::RowVectorXd unit = sign * Eigen::RowVectorXd::Unit(n, i);
      rows.add(unit, sign > 0.0 ? input.upper : -input.lower, -sign * selectors.reference.row(i % nu),
               rowName(input.name, sign, static_cast<int>(i / nu)));
    }
  }
  for (const double sign : {1.0, -1.0}) {
    for (std::size_t k = 0; k < prediction.input.size(); ++k) {
      const Eigen::MatrixXd on_theta = -sign * prediction.state[k] * selectors.error;
      for (int i = 0; i < problem.stateCount(); ++i) {
        const Signal& state = problem.states[static_cast<std::size_t>(i)];
        rows.add(sign * prediction.input[k].row(i), sign > 0.0 ? state.upper : -state.lower, on_theta.row(i),
                 rowName(state.name, sign, static_cast<int>(k) + 1));
      }
    }
  }
  rows.store(program, n, p);
}

// Where the input cannot hold its reference, bounds are active at many steps, in very many combinations.
std::vector<std::string> remarksOn(const MpcProblem& problem) {
  std::vector<std::string> remarks;
  for (const MpcProblem::Parameter& parameter : problem.parameters) {
    if (parameter.role != ParameterRole::kInputReference) continue;
    const Signal& input = problem.inputs[static_cast<std::size_t>(parameter.index)];
    const Signal& reference = parameter.signal;
    if (reference.lower >= input.lower && reference.upper <= input.upper) continue;
    std::ostringstream text;
    text << "parameters: " << reference.name << ": its range " << reference.lower << " .. " << reference.upper
         << " exceeds the bounds " << input.lower << " .. " << input.upper << " of " << input.name
         << ": no input holds such a reference, and the regions may become very many";
    remarks.push_back(text.str());
  }
  return remarks;
}

}  // namespace

ParametricProgram condense(const MpcProblem& problem) {
  const DiscreteModel model = discretise(problem, problem.sampling_time);
  const Prediction prediction = predict(model, problem.horizon);
  const Selectors selectors = select(problem);
  ParametricProgram program;
  program.name = problem.name;
  program.text = problem.text;
  program.text_kind = "yaml";
  program.period = problem.sampling_time;
  setCost(problem, model, prediction, selectors, &program);
  setRows(problem, prediction, selectors, &program);
  for (const MpcProblem::Parameter& parameter : problem.parameters)
    program.parameters.push_back(parameter.signal);
  program.inputs = problem.inputs;
  const Eigen::Index nu = problem.inputCount();
  program.E = Eigen::MatrixXd::Identity(nu, program.H.rows());
  program.C = selectors.reference;
  program.c = Eigen::VectorXd::Zero(nu);
  program.remarks = remarksOn(problem);
  checkProgram(program);
  return program;
}

}  // namespace polyfly
