#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "condense_parts.hpp"

namespace polyfly {
namespace {

// A row below this, relative to its parameter part, does not depend on z.
constexpr double kZeroRow = 1e-25;

double size(const WideMatrix& matrix) { return rounded(matrix).cwiseAbs().maxCoeff(); }

/// `sign` times the unit vector, as a row.
WideMatrix unitRow(double sign, Eigen::Index n, Eigen::Index i) {
  return wide(sign * Eigen::RowVectorXd::Unit(n, i));
}

WideMatrix zeroRow(Eigen::Index columns) { return WideMatrix::Zero(1, columns); }

/// Collects rows A z <= b + S theta; those without z become A_theta theta <= b_theta.
class Rows {
 public:
  struct Row {
    WideMatrix on_z, on_theta;
    double bound = 0.0;
    std::string name;
    // Slack that relaxes the row, or that it keeps at 0 or above; -1: none.
    int slack = -1;
  };

  /// Index of the row in A; -1 where it has become one of A_theta, or where the bound is infinite.
  int add(Row row) {
    if (!std::isfinite(row.bound)) return -1;
    const bool without_z = row.slack < 0 && size(row.on_z) <= kZeroRow * size(row.on_theta);
    std::vector<Row>& rows = without_z ? parameter_rows_ : rows_;
    rows.push_back(std::move(row));
    return without_z ? -1 : static_cast<int>(rows.size()) - 1;
  }

  /// z has n inputs, and the slacks of `program`.
  void store(WideProgram* numbers, ParametricProgram* program, Eigen::Index n, Eigen::Index p) const {
    const auto m = static_cast<Eigen::Index>(rows_.size());
    numbers->A = WideMatrix::Zero(m, n + static_cast<Eigen::Index>(program->slacks.size()));
    numbers->b.resize(m, 1);
    numbers->S.resize(m, p);
    for (Eigen::Index i = 0; i < m; ++i) {
      const Row& row = rows_[static_cast<std::size_t>(i)];
      numbers->A.row(i).head(n) = row.on_z;
      if (row.slack >= 0) numbers->A(i, n + row.slack) = -1.0;
      numbers->b(i) = row.bound;
      numbers->S.row(i) = row.on_theta;
      program->row_names.push_back(row.name);
    }
    const auto k = static_cast<Eigen::Index>(parameter_rows_.size());
    numbers->A_theta.resize(k, p);
    numbers->b_theta.resize(k, 1);
    for (Eigen::Index i = 0; i < k; ++i) {
      const Row& row = parameter_rows_[static_cast<std::size_t>(i)];
      numbers->A_theta.row(i) = -row.on_theta;
      numbers->b_theta(i) = row.bound;
    }
  }

 private:
  std::vector<Row> rows_, parameter_rows_;
};

std::string rowName(const std::string& subject, double sign, int step) {
  return subject + (sign > 0.0 ? " at its upper bound" : " at its lower bound") + ", step " +
         std::to_string(step);
}

double boundOf(const Signal& signal, double sign) { return sign > 0.0 ? signal.upper : -signal.lower; }

/// What happens in a prediction: first stage of each block of inputs, and the block of each stage.
struct Blocks {
  std::vector<int> first;
  std::vector<Eigen::Index> of_stage;
};

Blocks blocksOf(const MpcProblem& problem) {
  Blocks blocks;
  for (const int length : blockLengths(problem)) {
    blocks.first.push_back(static_cast<int>(blocks.of_stage.size()));
    blocks.of_stage.insert(blocks.of_stage.end(), static_cast<std::size_t>(length),
                           static_cast<Eigen::Index>(blocks.first.size()) - 1);
  }
  return blocks;
}

/// Bounds of inputs and of errors, upper ones first.
void addRanges(const MpcProblem& problem, const Prediction& prediction, const Selectors& selectors,
               Rows* rows) {
  const Eigen::Index nu = problem.inputCount();
  const Blocks blocks = blocksOf(problem);
  const Eigen::Index n = static_cast<Eigen::Index>(blocks.first.size()) * nu;
  for (const double sign : {1.0, -1.0}) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const Signal& input = problem.inputs[static_cast<std::size_t>(i % nu)];
      rows->add({unitRow(sign, n, i), selectors.reference.row(i % nu) * DoubleDouble(-sign),
                 boundOf(input, sign),
                 rowName(input.name, sign, blocks.first[static_cast<std::size_t>(i / nu)]), -1});
    }
  }
  for (const double sign : {1.0, -1.0}) {
    for (std::size_t k = 0; k < prediction.input.size(); ++k) {
      WideMatrix on_theta = prediction.state[k] * selectors.error * DoubleDouble(-sign);
      if (!prediction.drift.empty()) on_theta -= prediction.drift[k] * DoubleDouble(sign);
      for (int i = 0; i < problem.stateCount(); ++i) {
        const Signal& state = problem.states[static_cast<std::size_t>(i)];
        rows->add({prediction.input[k].row(i) * DoubleDouble(sign), on_theta.row(i), boundOf(state, sign),
                   rowName(state.name, sign, static_cast<int>(k) + 1), -1});
      }
    }
  }
}

/// Bounds on the change of u, upper ones first: within a block there is none.
void addChanges(const MpcProblem& problem, const Selectors& selectors, Rows* rows) {
  if (problem.changes.empty()) return;
  const Eigen::Index nu = problem.inputCount();
  const Blocks blocks = blocksOf(problem);
  const auto n = static_cast<Eigen::Index>(blocks.first.size()) * nu;
  for (const double sign : {1.0, -1.0}) {
    for (std::size_t block = 0; block < blocks.first.size(); ++block) {
      for (Eigen::Index i = 0; i < nu; ++i) {
        const Signal& change = problem.changes[static_cast<std::size_t>(i)];
        const Eigen::Index at = static_cast<Eigen::Index>(block) * nu + i;
        WideMatrix on_z = unitRow(sign, n, at);
        WideMatrix on_theta = zeroRow(selectors.change.cols());
        if (block > 0) on_z(at - nu) = -sign;
        if (block == 0) on_theta = selectors.change.row(i) * DoubleDouble(sign);
        rows->add({std::move(on_z), std::move(on_theta), boundOf(change, sign),
                   rowName(change.name, sign, blocks.first[block]), -1});
      }
    }
  }
}

/// T e_N <= t
void addTerminalSet(const MpcProblem& problem, const Prediction& prediction, const Selectors& selectors,
                    Rows* rows) {
  for (Eigen::Index i = 0; i < problem.T.rows(); ++i) {
    const WideMatrix T = wide(problem.T.row(i));
    WideMatrix on_theta = -(T * prediction.state.back() * selectors.error);
    if (!prediction.drift.empty()) on_theta -= T * prediction.drift.back();
    rows->add({T * prediction.input.back(), std::move(on_theta), problem.t(i),
               "row " + std::to_string(i) + " of the terminal set", -1});
  }
}

/// value = on_z z + on_theta theta
struct StageValue {
  WideMatrix on_z, on_theta;
};

/// What the rows of a constraint are made of.
struct Horizon {
  const Prediction& prediction;
  const Selectors& selectors;
  Blocks blocks;
};

/// G_x x_k + G_u u_k, or the same of the errors.
StageValue valueAt(int stage, const StageConstraint& constraint, const Horizon& horizon) {
  const Prediction& prediction = horizon.prediction;
  const Selectors& selectors = horizon.selectors;
  const Eigen::Index nu = constraint.G_u.size();
  StageValue value;
  const WideMatrix G_x = wide(constraint.G_x), G_u = wide(constraint.G_u);
  value.on_theta = zeroRow(selectors.error.cols());
  value.on_z = zeroRow(prediction.input.front().cols());
  if (stage == 0) {
    value.on_theta += G_x * selectors.error;
  } else {
    const auto k = static_cast<std::size_t>(stage) - 1;
    value.on_theta += G_x * prediction.state[k] * selectors.error;
    value.on_z += G_x * prediction.input[k];
    if (!prediction.drift.empty()) value.on_theta += G_x * prediction.drift[k];
  }
  if (constraint.absolute) value.on_theta += G_x * selectors.state + G_u * selectors.reference;
  if (!constraint.G_u.isZero(0.0))
    value.on_z.middleCols(horizon.blocks.of_stage[static_cast<std::size_t>(stage)] * nu, nu) += G_u;
  return value;
}

/// Appends one slack to z, with its cost.
int addSlack(const StageConstraint& constraint, WideProgram* numbers, ParametricProgram* program) {
  const Eigen::Index n = numbers->H.rows();
  numbers->H.conservativeResize(n + 1, n + 1);
  numbers->H.row(n).setZero();
  numbers->H.col(n).setZero();
  numbers->H(n, n) = 2.0 * constraint.quadratic_weight;
  numbers->f.conservativeResize(n + 1, 1);
  numbers->f(n) = constraint.linear_weight;
  numbers->F.conservativeResize(n + 1, Eigen::NoChange);
  numbers->F.row(n).setZero();
  SlackVariable slack;
  slack.variable = static_cast<int>(n);
  slack.name = constraint.signal.name;
  slack.unit = constraint.signal.unit;
  program->slacks.push_back(slack);
  return static_cast<int>(program->slacks.size()) - 1;
}

/// The rows of a bound; a soft one has slack variables, each of which relaxes both sides.
void addConstraint(const StageConstraint& constraint, const Horizon& horizon, Rows* rows,
                   WideProgram* numbers, ParametricProgram* program) {
  const int stages = static_cast<int>(horizon.prediction.input.size());
  const bool has_input = !constraint.G_u.isZero(0.0);
  const bool shared = constraint.slack == StageConstraint::Slack::kPerHorizon;
  const int first = has_input ? 0 : 1;
  int slack = -1;
  for (int stage = first; stage < first + stages; ++stage) {
    const StageValue value = valueAt(stage, constraint, horizon);
    if (constraint.soft && (slack < 0 || !shared)) slack = addSlack(constraint, numbers, program);
    for (const double sign : {1.0, -1.0}) {
      const int row =
          rows->add({value.on_z * DoubleDouble(sign), value.on_theta * DoubleDouble(-sign),
                     boundOf(constraint.signal, sign), rowName(constraint.signal.name, sign, stage), slack});
      if (slack >= 0 && row >= 0) program->slacks[static_cast<std::size_t>(slack)].rows.push_back(row);
    }
  }
}

/// v >= 0. Without a linear weight no optimum has a slack below 0, and the row would be redundant at each of them.
void addFloors(const StageConstraint& constraint, const WideProgram& numbers, Rows* rows,
               ParametricProgram* program) {
  if (!constraint.soft || constraint.linear_weight == 0.0) return;
  const Eigen::Index n = numbers.H.rows() - static_cast<Eigen::Index>(program->slacks.size());
  for (std::size_t i = 0; i < program->slacks.size(); ++i) {
    SlackVariable& slack = program->slacks[i];
    if (slack.name != constraint.signal.name) continue;
    slack.floor = rows->add(
        {zeroRow(n), zeroRow(numbers.F.cols()), 0.0, slack.name + " within its bounds", static_cast<int>(i)});
  }
}

}  // namespace

void setRows(const MpcProblem& problem, const Prediction& prediction, const Selectors& selectors,
             WideProgram* numbers, ParametricProgram* program) {
  const Eigen::Index n = numbers->H.rows();
  Rows rows;
  addRanges(problem, prediction, selectors, &rows);
  addChanges(problem, selectors, &rows);
  addTerminalSet(problem, prediction, selectors, &rows);
  const Horizon horizon{prediction, selectors, blocksOf(problem)};
  for (const StageConstraint& constraint : problem.constraints)
    addConstraint(constraint, horizon, &rows, numbers, program);
  for (const StageConstraint& constraint : problem.constraints)
    addFloors(constraint, *numbers, &rows, program);
  rows.store(numbers, program, n, static_cast<Eigen::Index>(problem.parameters.size()));
}

}  // namespace polyfly
