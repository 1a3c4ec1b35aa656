#include <Eigen/Core>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "condense_parts.hpp"
#include "mpc_core/decompositions.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// From so many free moves on, a parameter of what drifts is told of.
constexpr std::size_t kManyMoves = 10;

// A greater condition of H, with a diagonal of ones, would cost the law more than half of a double's digits.
constexpr double kGreatCondition = 1e8;

/// Of the matrix in units in which its diagonal is 1; infinite where doubles do not tell that it is definite.
double scaledCondition(const WideMatrix& matrix) {
  constexpr double kBeyond = std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd numbers = rounded(matrix);
  if (!numbers.allFinite() || !(numbers.diagonal().minCoeff() > 0.0)) return kBeyond;
  const Eigen::VectorXd units = numbers.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd values = symmetricEigenvalues(units.asDiagonal() * numbers * units.asDiagonal());
  const double least = values(0), greatest = values(values.size() - 1);
  return least > 0.0 ? greatest / least : kBeyond;
}

/// Half of the cost of the inputs' own changes and sizes.
void addInputCost(const MpcProblem& problem, WideMatrix* H) {
  const DoubleDouble two = 2.0;
  const WideMatrix R = wide(problem.R) * two, R_delta = wide(problem.R_delta) * two;
  const std::vector<int> blocks = blockLengths(problem);
  const Eigen::Index nu = problem.inputCount();
  for (std::size_t block = 0; block < blocks.size(); ++block) {
    const Eigen::Index i = static_cast<Eigen::Index>(block) * nu;
    H->block(i, i, nu, nu) += R * DoubleDouble(blocks[block]) + R_delta;
    if (block + 1 == blocks.size()) continue;
    H->block(i, i, nu, nu) += R_delta;
    H->block(i, i + nu, nu, nu) -= R_delta;
    H->block(i + nu, i, nu, nu) -= R_delta;
  }
}

/// 1/2 z'Hz + (F theta)'z equals Eq. 4 but for terms without z; hence the factors 2. z are the inputs.
void setCost(const MpcProblem& problem, const WideModel& model, const Prediction& prediction,
             const Selectors& selectors, WideProgram* numbers) {
  const DoubleDouble two = 2.0;
  const WideMatrix P = wideTerminalWeight(problem, model) * two, Q = wide(problem.Q) * two;
  const Eigen::Index nu = problem.inputCount(), n = prediction.moves.front().on_z.cols();
  numbers->H = WideMatrix::Zero(n, n);
  numbers->F = WideMatrix::Zero(n, selectors.error.cols());
  Eigen::Index moved = 0;  // inputs that have acted so far
  int k = 0;
  for (const int length : blockLengths(problem)) {
    moved += nu;
    for (const int last = k + length; k < last;) {
      const Affine& error = prediction.errors[static_cast<std::size_t>(++k)];
      const WideMatrix input = error.on_z.leftCols(moved);
      const WideMatrix weighted = (k < problem.horizon ? Q : P) * input;
      numbers->H.topLeftCorner(moved, moved) += input.transpose() * weighted;
      numbers->F.topRows(moved) += weighted.transpose() * error.on_theta;
    }
  }
  addInputCost(problem, &numbers->H);
  numbers->H = ((numbers->H + numbers->H.transpose()) * DoubleDouble(0.5)).eval();
  numbers->F.topRows(nu) -= wide(problem.R_delta) * two * selectors.change;
}

/// A problem whose parameters are all entries of theta, in the variables in which H is well conditioned.
struct Formulation {
  Selectors selectors;
  Prediction prediction;
  /// H, f and F of the inputs alone.
  WideProgram numbers;
};

Formulation formulate(const MpcProblem& problem, const WideModel& model) {
  Formulation result;
  result.selectors = selectorsOf(problem, model);
  result.prediction = predict(problem, model, result.selectors, nullptr);
  setCost(problem, model, result.prediction, result.selectors, &result.numbers);
  // With blocks, the inputs of a stage are not free to follow a feedback.
  if (problem.moves.empty() && problem.horizon > 1 && scaledCondition(result.numbers.H) > kGreatCondition) {
    const Feedback feedback = feedbackOf(problem, model, result.selectors);
    result.prediction = predict(problem, model, result.selectors, &feedback);
    result.numbers.H = feedback.H;
    result.numbers.F = feedback.F;
  }
  result.numbers.f = WideMatrix::Zero(result.numbers.H.rows(), 1);
  return result;
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

/// u~ of the blocks. Parameters with a value count in the constant.
InputPlan planOf(const MpcProblem& problem, const Prediction& prediction) {
  const auto p = static_cast<Eigen::Index>(problem.parameters.size());
  const Eigen::Index nu = problem.inputCount(), n = prediction.moves.front().on_z.cols();
  InputPlan plan{Eigen::MatrixXd(n, n), Eigen::MatrixXd(n, p), Eigen::VectorXd(n)};
  const Eigen::VectorXd fixed = fixedValues(problem);
  Eigen::Index at = 0;
  std::size_t stage = 0;
  for (const int length : blockLengths(problem)) {
    const Eigen::MatrixXd on_theta = rounded(prediction.moves[stage].on_theta);
    plan.on_z.middleRows(at, nu) = rounded(prediction.moves[stage].on_z);
    plan.on_theta.middleRows(at, nu) = on_theta.leftCols(p);
    plan.constant.segment(at, nu) = on_theta.rightCols(fixed.size()) * fixed;
    at += nu;
    stage += static_cast<std::size_t>(length);
  }
  return plan;
}

}  // namespace

std::string placeOf(const MpcProblem& problem) {
  return problem.source.empty() ? problem.name : problem.source;
}

std::vector<int> blockLengths(const MpcProblem& problem) {
  return problem.moves.empty() ? std::vector<int>(static_cast<std::size_t>(problem.horizon), 1)
                               : problem.moves;
}

Eigen::MatrixXd terminalWeight(const MpcProblem& problem, const DiscreteModel& model) {
  return problem.P.size() > 0 ? problem.P : solveRiccati(model.A, model.B, problem.Q, problem.R);
}

ParametricProgram condense(const MpcProblem& problem, InputPlan* plan) {
  const WideModel model = wideModel(problem, problem.sampling_time);
  const MpcProblem all = withFixedAsParameters(problem);
  auto [selectors, prediction, numbers] = formulate(all, model);
  ParametricProgram program;
  program.name = problem.name;
  program.text = problem.text;
  program.text_kind = "yaml";
  program.period = problem.sampling_time;
  setRows(all, prediction, selectors, &numbers, &program);
  for (const MpcProblem::Parameter& parameter : problem.parameters)
    program.parameters.push_back(parameter.signal);
  program.inputs = problem.inputs;
  const Eigen::Index nu = problem.inputCount();
  numbers.C = selectors.reference + prediction.moves.front().on_theta;
  numbers.c = WideMatrix::Zero(nu, 1);
  fixLastParameters(fixedValues(problem), &numbers);
  setRounded(numbers, &program);
  program.E = Eigen::MatrixXd::Identity(nu, program.H.rows());
  program.remarks = remarksOn(problem);
  for (std::string& remark : remarksOnDrift(problem)) program.remarks.push_back(std::move(remark));
  checkProgram(program);
  requireSmallRounding(problem, prediction, numbers, program);
  if (plan != nullptr) *plan = planOf(problem, prediction);
  return program;
}

Eigen::MatrixXd costAtZero(const MpcProblem& problem) {
  const WideModel model = wideModel(problem, problem.sampling_time);
  const MpcProblem all = withFixedAsParameters(problem);
  const auto [selectors, prediction, numbers] = formulate(all, model);
  const WideMatrix P = wideTerminalWeight(problem, model), Q = wide(problem.Q), R = wide(problem.R),
                   R_delta = wide(problem.R_delta);
  const Eigen::Index values = selectors.error.cols();
  WideMatrix cost = WideMatrix::Zero(values, values);
  const auto add = [&cost](const WideMatrix& weight, const WideMatrix& value) {
    cost += value.transpose() * weight * value;
  };
  const WideMatrix* before = &selectors.change;
  for (std::size_t k = 0; k < prediction.moves.size(); ++k) {
    const WideMatrix& move = prediction.moves[k].on_theta;
    add(Q, prediction.errors[k].on_theta);
    add(R, move);
    add(R_delta, move - *before);
    before = &move;
  }
  add(P, prediction.errors.back().on_theta);
  // (theta, 1) from the parameters and the fixed ones.
  const auto p = static_cast<Eigen::Index>(problem.parameters.size());
  Eigen::MatrixXd of_parameters = Eigen::MatrixXd::Zero(values, p + 1);
  of_parameters.topLeftCorner(p, p).setIdentity();
  of_parameters.bottomRightCorner(values - p, 1) = fixedValues(problem);
  return of_parameters.transpose() * rounded(cost) * of_parameters;
}

}  // namespace polyfly
