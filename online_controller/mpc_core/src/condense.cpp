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

Prediction predict(const MpcProblem& problem, const WideModel& model, const Selectors& selectors) {
  const Eigen::Index nx = model.A.rows();
  const Eigen::Index nu = model.B.cols();
  const std::vector<int> blocks = blockLengths(problem);
  const bool drifts = !rounded(selectors.drift).isZero(0.0);
  Prediction prediction;
  WideMatrix state = WideMatrix::Identity(nx, nx);
  WideMatrix input = WideMatrix::Zero(nx, static_cast<Eigen::Index>(blocks.size()) * nu);
  WideMatrix drift = WideMatrix::Zero(nx, selectors.drift.cols());
  for (std::size_t block = 0; block < blocks.size(); ++block) {
    const Eigen::Index before = static_cast<Eigen::Index>(block) * nu;
    auto of_block = input.middleCols(before, nu);
    for (int k = 0; k < blocks[block]; ++k) {
      state = (model.A * state).eval();
      input.leftCols(before + nu) = (model.A * input.leftCols(before + nu)).eval();
      of_block += model.B;
      prediction.state.push_back(state);
      prediction.input.push_back(input);
      if (!drifts) continue;
      drift = (model.A * drift + selectors.drift).eval();
      prediction.drift.push_back(drift);
    }
  }
  return prediction;
}

WideMatrix wideTerminalWeight(const MpcProblem& problem, const WideModel& model) {
  return problem.P.size() > 0 ? wide(problem.P)
                              : wideRiccati(model.A, model.B, wide(problem.Q), wide(problem.R));
}

/// 1/2 z'Hz + (F theta)'z equals Eq. 4 but for terms without z; hence the factors 2.
void setCost(const MpcProblem& problem, const WideModel& model, const Prediction& prediction,
             const Selectors& selectors, WideProgram* numbers) {
  const int N = problem.horizon;
  const std::vector<int> blocks = blockLengths(problem);
  const Eigen::Index nu = problem.inputCount();
  const Eigen::Index n = static_cast<Eigen::Index>(blocks.size()) * nu;
  const DoubleDouble two = 2.0;
  const WideMatrix P = wideTerminalWeight(problem, model) * two;
  const WideMatrix Q = wide(problem.Q) * two, R = wide(problem.R) * two,
                   R_delta = wide(problem.R_delta) * two;
  numbers->H = WideMatrix::Zero(n, n);
  WideMatrix F_error = WideMatrix::Zero(n, problem.stateCount());
  WideMatrix F_drift = WideMatrix::Zero(n, selectors.drift.cols());
  Eigen::Index moved = 0;  // inputs that have acted so far
  int k = 0;
  for (const int length : blocks) {
    moved += nu;
    for (const int last = k + length; k < last; ++k) {
      const auto stage = static_cast<std::size_t>(k);
      const WideMatrix input = prediction.input[stage].leftCols(moved);
      const WideMatrix weighted = (k + 1 < N ? Q : P) * input;
      numbers->H.topLeftCorner(moved, moved) += input.transpose() * weighted;
      F_error.topRows(moved) += weighted.transpose() * prediction.state[stage];
      if (!prediction.drift.empty()) F_drift.topRows(moved) += weighted.transpose() * prediction.drift[stage];
    }
  }
  for (std::size_t block = 0; block < blocks.size(); ++block) {
    const Eigen::Index i = static_cast<Eigen::Index>(block) * nu;
    numbers->H.block(i, i, nu, nu) += R * DoubleDouble(blocks[block]) + R_delta;
    if (block + 1 == blocks.size()) continue;
    numbers->H.block(i, i, nu, nu) += R_delta;
    numbers->H.block(i, i + nu, nu, nu) -= R_delta;
    numbers->H.block(i + nu, i, nu, nu) -= R_delta;
  }
  numbers->H = ((numbers->H + numbers->H.transpose()) * DoubleDouble(0.5)).eval();
  numbers->f = WideMatrix::Zero(n, 1);
  numbers->F = F_error * selectors.error;
  if (!prediction.drift.empty()) numbers->F += F_drift;
  numbers->F.topRows(nu) -= R_delta * selectors.change;
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
void fixLastParameters(const Eigen::VectorXd& values, WideProgram* numbers) {
  const Eigen::Index fixed = values.size();
  if (fixed == 0) return;
  const Eigen::Index p = numbers->F.cols() - fixed;
  const WideMatrix at = wide(values);
  numbers->f += numbers->F.rightCols(fixed) * at;
  numbers->b += numbers->S.rightCols(fixed) * at;
  numbers->b_theta -= numbers->A_theta.rightCols(fixed) * at;
  numbers->c += numbers->C.rightCols(fixed) * at;
  for (WideMatrix* matrix : {&numbers->F, &numbers->S, &numbers->A_theta, &numbers->C})
    matrix->conservativeResize(Eigen::NoChange, p);
}

void setRounded(const WideProgram& numbers, ParametricProgram* program) {
  program->H = rounded(numbers.H);
  program->f = rounded(numbers.f);
  program->F = rounded(numbers.F);
  program->A = rounded(numbers.A);
  program->b = rounded(numbers.b);
  program->S = rounded(numbers.S);
  program->A_theta = rounded(numbers.A_theta);
  program->b_theta = rounded(numbers.b_theta);
  program->C = rounded(numbers.C);
  program->c = rounded(numbers.c);
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
  const WideModel model = wideModel(problem, problem.sampling_time);
  const MpcProblem all = withFixedAsParameters(problem);
  const Selectors selectors = selectorsOf(all, model);
  const Prediction prediction = predict(all, model, selectors);
  ParametricProgram program;
  program.name = problem.name;
  program.text = problem.text;
  program.text_kind = "yaml";
  program.period = problem.sampling_time;
  WideProgram numbers;
  setCost(all, model, prediction, selectors, &numbers);
  setRows(all, prediction, selectors, &numbers, &program);
  for (const MpcProblem::Parameter& parameter : problem.parameters)
    program.parameters.push_back(parameter.signal);
  program.inputs = problem.inputs;
  const Eigen::Index nu = problem.inputCount();
  numbers.C = selectors.reference;
  numbers.c = WideMatrix::Zero(nu, 1);
  fixLastParameters(fixedValues(problem), &numbers);
  setRounded(numbers, &program);
  program.E = Eigen::MatrixXd::Identity(nu, program.H.rows());
  program.remarks = remarksOn(problem);
  for (std::string& remark : remarksOnDrift(problem)) program.remarks.push_back(std::move(remark));
  checkProgram(program);
  requireSmallRounding(problem, prediction, numbers, program);
  return program;
}

Eigen::MatrixXd costAtZero(const MpcProblem& problem) {
  const WideModel model = wideModel(problem, problem.sampling_time);
  const MpcProblem all = withFixedAsParameters(problem);
  const Selectors selectors = selectorsOf(all, model);
  const WideMatrix P = wideTerminalWeight(problem, model), Q = wide(problem.Q);
  WideMatrix errors = selectors.error;
  WideMatrix cost = selectors.change.transpose() * wide(problem.R_delta) * selectors.change;
  for (int k = 0; k < problem.horizon; ++k) {
    cost += errors.transpose() * Q * errors;
    errors = (model.A * errors + selectors.drift).eval();
  }
  cost += errors.transpose() * P * errors;
  // (theta, 1) from the parameters and the fixed ones.
  const auto p = static_cast<Eigen::Index>(problem.parameters.size());
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(errors.cols(), p + 1);
  values.topLeftCorner(p, p).setIdentity();
  values.bottomRightCorner(errors.cols() - p, 1) = fixedValues(problem);
  return values.transpose() * rounded(cost) * values;
}

}  // namespace polyfly
