#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "condense_parts.hpp"
#include "mpc_core/decompositions.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// A row below this, relative to its parameter part, does not depend on z.
constexpr double kZeroRow = 1e-25;

double size(const WideMatrix& matrix) { return rounded(matrix).cwiseAbs().maxCoeff(); }

WideMatrix zeroRows(Eigen::Index rows, Eigen::Index columns) { return WideMatrix::Zero(rows, columns); }

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

/// First stage of each block of inputs.
std::vector<int> firstStages(const MpcProblem& problem) {
  std::vector<int> first;
  int stage = 0;
  for (const int length : blockLengths(problem)) {
    first.push_back(stage);
    stage += length;
  }
  return first;
}

Affine rowOf(const Affine& value, Eigen::Index i) { return {value.on_z.row(i), value.on_theta.row(i)}; }

/// sign value <= bound
Rows::Row oneSide(const Affine& value, double sign, double bound, std::string name, int slack = -1) {
  return {value.on_z * DoubleDouble(sign), value.on_theta * DoubleDouble(-sign), bound, std::move(name),
          slack};
}

/// Bounds of inputs and of errors, upper ones first.
void addRanges(const MpcProblem& problem, const Prediction& prediction, const Selectors& selectors,
               Rows* rows) {
  for (const double sign : {1.0, -1.0}) {
    for (const int stage : firstStages(problem)) {
      for (Eigen::Index i = 0; i < problem.inputCount(); ++i) {
        const Signal& input = problem.inputs[static_cast<std::size_t>(i)];
        Affine value = rowOf(prediction.moves[static_cast<std::size_t>(stage)], i);
        value.on_theta += selectors.reference.row(i);
        rows->add(oneSide(value, sign, boundOf(input, sign), rowName(input.name, sign, stage)));
      }
    }
  }
  for (const double sign : {1.0, -1.0}) {
    for (int k = 1; k <= problem.horizon; ++k) {
      for (int i = 0; i < problem.stateCount(); ++i) {
        const Signal& state = problem.states[static_cast<std::size_t>(i)];
        rows->add(oneSide(rowOf(prediction.errors[static_cast<std::size_t>(k)], i), sign,
                          boundOf(state, sign), rowName(state.name, sign, k)));
      }
    }
  }
}

/// Bounds on the change of u, upper ones first: within a block there is none.
void addChanges(const MpcProblem& problem, const Prediction& prediction, const Selectors& selectors,
                Rows* rows) {
  if (problem.changes.empty()) return;
  const Affine before{zeroRows(selectors.change.rows(), prediction.moves.front().on_z.cols()),
                      selectors.change};
  for (const double sign : {1.0, -1.0}) {
    for (const int stage : firstStages(problem)) {
      const auto k = static_cast<std::size_t>(stage);
      const Affine& last = stage == 0 ? before : prediction.moves[k - 1];
      for (Eigen::Index i = 0; i < problem.inputCount(); ++i) {
        const Signal& change = problem.changes[static_cast<std::size_t>(i)];
        Affine value = rowOf(prediction.moves[k], i);
        value.on_z -= last.on_z.row(i);
        value.on_theta -= last.on_theta.row(i);
        rows->add(oneSide(value, sign, boundOf(change, sign), rowName(change.name, sign, stage)));
      }
    }
  }
}

/// T e_N <= t
void addTerminalSet(const MpcProblem& problem, const Prediction& prediction, Rows* rows) {
  for (Eigen::Index i = 0; i < problem.T.rows(); ++i) {
    const WideMatrix T = wide(problem.T.row(i));
    const Affine& last = prediction.errors.back();
    rows->add(oneSide({T * last.on_z, T * last.on_theta}, 1.0, problem.t(i),
                      "row " + std::to_string(i) + " of the terminal set"));
  }
}

/// Directions of e_N that the inputs move, in units in which the greatest entry of each row is 1.
Eigen::Index reachedDirections(const WideMatrix& on_z) {
  constexpr double kRank = 1e-11;
  Eigen::MatrixXd rows = rounded(on_z);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const double greatest = rows.row(i).cwiseAbs().maxCoeff();
    if (greatest > 0.0) rows.row(i) /= greatest;
  }
  return PivotedQr(rows.transpose(), kRank).rank();
}

/// e_N = 0
void addTerminalEquality(const MpcProblem& problem, const Prediction& prediction, Rows* rows,
                         ParametricProgram* program) {
  if (!problem.terminal_equality) return;
  const Affine& last = prediction.errors.back();
  if (reachedDirections(last.on_z) < problem.stateCount())
    throw Error(placeOf(problem) +
                ": weights.terminal: equality needs inputs that reach every state within the horizon");
  for (int i = 0; i < problem.stateCount(); ++i)
    program->equalities.push_back(
        rows->add(oneSide(rowOf(last, i), 1.0, 0.0,
                          problem.states[static_cast<std::size_t>(i)].name + " at its reference, step " +
                              std::to_string(problem.horizon))));
}

/// What the rows of a constraint are made of.
struct Horizon {
  const Prediction& prediction;
  const Selectors& selectors;
};

/// G_x x_k + G_u u_k, or the same of the errors.
Affine valueAt(int stage, const StageConstraint& constraint, const Horizon& horizon) {
  const Selectors& selectors = horizon.selectors;
  const WideMatrix G_x = wide(constraint.G_x), G_u = wide(constraint.G_u);
  const Affine& error = horizon.prediction.errors[static_cast<std::size_t>(stage)];
  Affine value{G_x * error.on_z, G_x * error.on_theta};
  if (constraint.absolute) value.on_theta += G_x * selectors.state + G_u * selectors.reference;
  if (constraint.G_u.isZero(0.0)) return value;
  const Affine& move = horizon.prediction.moves[static_cast<std::size_t>(stage)];
  value.on_z += G_u * move.on_z;
  value.on_theta += G_u * move.on_theta;
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
  const int stages = static_cast<int>(horizon.prediction.moves.size());
  const bool has_input = !constraint.G_u.isZero(0.0);
  const bool shared = constraint.slack == StageConstraint::Slack::kPerHorizon;
  const int first = has_input ? 0 : 1;
  int slack = -1;
  for (int stage = first; stage < first + stages; ++stage) {
    const Affine value = valueAt(stage, constraint, horizon);
    if (constraint.soft && (slack < 0 || !shared)) slack = addSlack(constraint, numbers, program);
    for (const double sign : {1.0, -1.0}) {
      const int row = rows->add(oneSide(value, sign, boundOf(constraint.signal, sign),
                                        rowName(constraint.signal.name, sign, stage), slack));
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
    slack.floor = rows->add({zeroRows(1, n), zeroRows(1, numbers.F.cols()), 0.0,
                             slack.name + " within its bounds", static_cast<int>(i)});
  }
}

}  // namespace

void setRows(const MpcProblem& problem, const Prediction& prediction, const Selectors& selectors,
             WideProgram* numbers, ParametricProgram* program) {
  const Eigen::Index n = numbers->H.rows();
  Rows rows;
  addRanges(problem, prediction, selectors, &rows);
  addChanges(problem, prediction, selectors, &rows);
  addTerminalSet(problem, prediction, &rows);
  addTerminalEquality(problem, prediction, &rows, program);
  const Horizon horizon{prediction, selectors};
  for (const StageConstraint& constraint : problem.constraints)
    addConstraint(constraint, horizon, &rows, numbers, program);
  for (const StageConstraint& constraint : problem.constraints)
    addFloors(constraint, *numbers, &rows, program);
  rows.store(numbers, program, n, static_cast<Eigen::Index>(problem.parameters.size()));
}

}  // namespace polyfly
