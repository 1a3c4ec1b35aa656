#include <Eigen/Core>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "condense_parts.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// From so many free moves on, a parameter of what drifts is told of.
constexpr std::size_t kManyMoves = 10;

Prediction predict(const MpcProblem& problem, const DiscreteModel& model, const Selectors& selectors) {
  const Eigen::Index nx = model.A.rows();
  const Eigen::Index nu = model.B.cols();
  const std::vector<int> blocks = blockLengths(problem);
  const bool drifts = !selectors.drift.isZero(0.0);
  Prediction prediction;
  Eigen::MatrixXd state = Eigen::MatrixXd::Identity(nx, nx);
  Eigen::MatrixXd input = Eigen::MatrixXd::Zero(nx, static_cast<Eigen::Index>(blocks.size()) * nu);
  Eigen::MatrixXd drift = Eigen::MatrixXd::Zero(nx, selectors.drift.cols());
  for (std::size_t block = 0; block < blocks.size(); ++block) {
    auto of_block = input.middleCols(static_cast<Eigen::Index>(block) * nu, nu);
    for (int k = 0; k < blocks[block]; ++k) {
      state = (model.A * state).eval();
      input = (model.A * input).eval();
      if (k == 0) {
        of_block = model.B;
      } else {
        of_block += model.B;
      }
      prediction.state.push_back(state);
      prediction.input.push_back(input);
      if (!drifts) continue;
      drift = (model.A * drift + selectors.drift).eval();
      prediction.drift.push_back(drift);
    }
  }
  return prediction;
}

/// 1/2 z'Hz + (F theta)'z equals Eq. 4 but for terms without z; hence the factors 2.
void setCost(const MpcProblem& problem, const DiscreteModel& model, const Prediction& prediction,
             const Selectors& selectors, ParametricProgram* program) {
  const int N = problem.horizon;
  const std::vector<int> blocks = blockLengths(problem);
  const Eigen::Index nu = problem.inputCount();
  const Eigen::Index n = static_cast<Eigen::Index>(blocks.size()) * nu;
  const Eigen::MatrixXd P = terminalWeight(problem, model);
  program->H = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd F_error = Eigen::MatrixXd::Zero(n, problem.stateCount());
  Eigen::MatrixXd F_drift = Eigen::MatrixXd::Zero(n, selectors.drift.cols());
  for (int k = 0; k < N; ++k) {
    const auto stage = static_cast<std::size_t>(k);
    const Eigen::MatrixXd weighted = (k + 1 < N ? problem.Q : P) * prediction.input[stage];
    program->H.noalias() += 2.0 * prediction.input[stage].transpose() * weighted;
    F_error.noalias() += 2.0 * weighted.transpose() * prediction.state[stage];
    if (!prediction.drift.empty()) F_drift.noalias() += 2.0 * weighted.transpose() * prediction.drift[stage];
  }
  for (std::size_t block = 0; block < blocks.size(); ++block) {
    const Eigen::Index i = static_cast<Eigen::Index>(block) * nu;
    program->H.block(i, i, nu, nu) +=
        2.0 * (static_cast<double>(blocks[block]) * problem.R + problem.R_delta);
    if (block + 1 == blocks.size()) continue;
    program->H.block(i, i, nu, nu) += 2.0 * problem.R_delta;
    program->H.block(i, i + nu, nu, nu) -= 2.0 * problem.R_delta;
    program->H.block(i + nu, i, nu, nu) -= 2.0 * problem.R_delta;
  }
  program->H = (0.5 * (program->H + program->H.transpose())).eval();
  program->f = Eigen::VectorXd::Zero(n);
  program->F = F_error * selectors.error;
  if (!prediction.drift.empty()) program->F += F_drift;
  program->F.topRows(nu) -= 2.0 * problem.R_delta * selectors.change;
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

// A parameter of what drifts moves the whole prediction, and with it the bounds that are active at each free move.
std::vector<std::string> remarksOnDrift(const MpcProblem& problem) {
  const std::size_t free_moves = blockLengths(problem).size();
  if (free_moves < kManyMoves) return {};
  std::vector<std::string> remarks;
  for (const MpcProblem::Parameter& parameter : problem.parameters) {
    if (parameter.role != ParameterRole::kDisturbance) continue;
    remarks.push_back(
        "parameters: " + parameter.signal.name + ": with " + std::to_string(free_moves) +
        " free moves it may multiply the regions of a map; a few blocks (moves: [1, 1, 2, 4, ...]) "
        "keep them few");
  }
  return remarks;
}

/// The problem with its fixed parameters as further entries of theta.
MpcProblem withFixedAsParameters(const MpcProblem& problem) {
  MpcProblem all = problem;
  all.parameters.insert(all.parameters.end(), problem.fixed_parameters.begin(),
                        problem.fixed_parameters.end());
  all.fixed_parameters.clear();
  return all;
}

Eigen::VectorXd fixedValues(const MpcProblem& problem) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(problem.fixed_parameters.size()));
  for (Eigen::Index i = 0; i < values.size(); ++i)
    values(i) = problem.fixed_parameters[static_cast<std::size_t>(i)].signal.lower;
  return values;
}

/// Puts values in place of the last parameters.
void fixLastParameters(const Eigen::VectorXd& values, ParametricProgram* program) {
  const Eigen::Index fixed = values.size();
  if (fixed == 0) return;
  const Eigen::Index p = program->F.cols() - fixed;
  program->f += program->F.rightCols(fixed) * values;
  program->b += program->S.rightCols(fixed) * values;
  program->b_theta -= program->A_theta.rightCols(fixed) * values;
  program->c += program->C.rightCols(fixed) * values;
  for (Eigen::MatrixXd* matrix : {&program->F, &program->S, &program->A_theta, &program->C})
    matrix->conservativeResize(Eigen::NoChange, p);
}

}  // namespace

std::vector<int> blockLengths(const MpcProblem& problem) {
  return problem.moves.empty() ? std::vector<int>(static_cast<std::size_t>(problem.horizon), 1)
                               : problem.moves;
}

Eigen::MatrixXd terminalWeight(const MpcProblem& problem, const DiscreteModel& model) {
  return problem.P.size() > 0 ? problem.P : solveRiccati(model.A, model.B, problem.Q, problem.R);
}

ParametricProgram condense(const MpcProblem& problem) {
  const DiscreteModel model = discretise(problem, problem.sampling_time);
  const MpcProblem all = withFixedAsParameters(problem);
  const Selectors selectors = selectorsOf(all, model);
  const Prediction prediction = predict(all, model, selectors);
  ParametricProgram program;
  program.name = problem.name;
  program.text = problem.text;
  program.text_kind = "yaml";
  program.period = problem.sampling_time;
  setCost(all, model, prediction, selectors, &program);
  setRows(all, prediction, selectors, &program);
  for (const MpcProblem::Parameter& parameter : problem.parameters)
    program.parameters.push_back(parameter.signal);
  program.inputs = problem.inputs;
  const Eigen::Index nu = problem.inputCount();
  program.E = Eigen::MatrixXd::Identity(nu, program.H.rows());
  program.C = selectors.reference;
  program.c = Eigen::VectorXd::Zero(nu);
  fixLastParameters(fixedValues(problem), &program);
  program.remarks = remarksOn(problem);
  for (std::string& remark : remarksOnDrift(problem)) program.remarks.push_back(std::move(remark));
  checkProgram(program);
  return program;
}

Eigen::MatrixXd costAtZero(const MpcProblem& problem) {
  const DiscreteModel model = discretise(problem, problem.sampling_time);
  const MpcProblem all = withFixedAsParameters(problem);
  const Selectors selectors = selectorsOf(all, model);
  const Eigen::MatrixXd P = terminalWeight(problem, model);
  Eigen::MatrixXd errors = selectors.error;
  Eigen::MatrixXd cost = selectors.change.transpose() * problem.R_delta * selectors.change;
  for (int k = 0; k < problem.horizon; ++k) {
    cost += errors.transpose() * problem.Q * errors;
    errors = (model.A * errors + selectors.drift).eval();
  }
  cost += errors.transpose() * P * errors;
  // (theta, 1) from the parameters and the fixed ones.
  const auto p = static_cast<Eigen::Index>(problem.parameters.size());
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(errors.cols(), p + 1);
  values.topLeftCorner(p, p).setIdentity();
  values.bottomRightCorner(errors.cols() - p, 1) = fixedValues(problem);
  return values.transpose() * cost * values;
}

}  // namespace polyfly
