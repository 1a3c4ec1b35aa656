#include <cstdio>

#include "mpc_core/safety_filter.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

std::string exactText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string listText(const Eigen::VectorXd& values) {
  std::string text = "[";
  for (Eigen::Index i = 0; i < values.size(); ++i) text += (i > 0 ? ", " : "") + exactText(values[i]);
  return text + "]";
}

std::string rowsText(const char* key, const Eigen::MatrixXd& matrix) {
  std::string text = std::string("  ") + key + ":\n";
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    text += "    - " + listText(matrix.row(i).transpose()) + "\n";
  return text;
}

bool boundsInput(const SafeSet& set, Eigen::Index row) { return !set.G.row(row).isZero(0.0); }

// G u <= b + M xi, after the bounds of the input; rows without u as bounds of theta.
void setFilterRows(const SafetyFilterProblem& problem, ParametricProgram& program) {
  const SafeSet& set = *problem.safe_set;
  const Eigen::Index nu = problem.inputCount(), n = problem.augmentedCount();
  Eigen::Index rows = 2 * nu, bounds = 0;
  for (Eigen::Index i = 0; i < set.G.rows(); ++i) ++(boundsInput(set, i) ? rows : bounds);
  program.A = Eigen::MatrixXd::Zero(rows, nu);
  program.b = Eigen::VectorXd::Zero(rows);
  program.S = Eigen::MatrixXd::Zero(rows, n + nu);
  program.A_theta = Eigen::MatrixXd::Zero(bounds, n + nu);
  program.b_theta = Eigen::VectorXd::Zero(bounds);
  for (Eigen::Index j = 0; j < nu; ++j) {
    const Signal& input = problem.inputs[static_cast<std::size_t>(j)];
    program.A(2 * j, j) = 1.0;
    program.b[2 * j] = input.upper;
    program.A(2 * j + 1, j) = -1.0;
    program.b[2 * j + 1] = -input.lower;
    program.row_names.push_back(input.name + " at its upper bound");
    program.row_names.push_back(input.name + " at its lower bound");
  }
  Eigen::Index row = 2 * nu, bound = 0;
  for (Eigen::Index i = 0; i < set.G.rows(); ++i) {
    if (boundsInput(set, i)) {
      program.A.row(row) = set.G.row(i);
      program.b[row] = set.b[i];
      program.S.row(row).head(n) = set.M.row(i);
      program.row_names.push_back("facet " + std::to_string(i) + " of the safe set, one period ahead");
      ++row;
    } else {
      program.A_theta.row(bound).head(n) = -set.M.row(i);
      program.b_theta[bound] = set.b[i];
      ++bound;
    }
  }
}

}  // namespace

ParametricProgram filterProgram(const SafetyFilterProblem& problem) {
  if (!problem.safe_set)
    throw Error(problem.source + ": safe_set: missing; `offline_mpt solve` computes it into the map");
  const Eigen::Index nu = problem.inputCount(), n = problem.augmentedCount();
  ParametricProgram program;
  program.name = problem.name;
  program.text = problem.text;
  program.text_kind = "yaml";
  program.period = problem.sampling_time;
  program.parameters = problem.augmentedStates();
  program.parameters.insert(program.parameters.end(), problem.wishes.begin(), problem.wishes.end());
  program.inputs = problem.inputs;
  program.H = problem.weights.asDiagonal();
  program.f = Eigen::VectorXd::Zero(nu);
  program.F = Eigen::MatrixXd::Zero(nu, n + nu);
  program.F.rightCols(nu) = -program.H;
  setFilterRows(problem, program);
  program.E = Eigen::MatrixXd::Identity(nu, nu);
  program.C = Eigen::MatrixXd::Zero(nu, n + nu);
  program.c = Eigen::VectorXd::Zero(nu);
  checkProgram(program);
  return program;
}

std::string withSafeSet(const SafetyFilterProblem& problem, const SafeSet& set) {
  std::string text = problem.text;
  if (!text.empty() && text.back() != '\n') text += '\n';
  text +=
      "\n# Computed by `offline_mpt solve`: {xi : H xi <= k}; u is admissible if G u <= b + M "
      "xi.\nsafe_set:\n";
  text += rowsText("H", set.H) + "  k: " + listText(set.k) + "\n" + rowsText("G", set.G) +
          "  b: " + listText(set.b) + "\n" + rowsText("M", set.M);
  return text;
}

}  // namespace polyfly
