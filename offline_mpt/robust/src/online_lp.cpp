#include "robust_mpc/online_lp.hpp"

#include <algorithm>
#include <utility>

#include "integer_program.hpp"
#include "polyfly_base/error.hpp"
#include "rational_parts.hpp"
#include "tolerances.hpp"

namespace polyfly {
namespace {

/// Rows in x = (z, u~_0, tau, distance) or, without a distance, (z, u~_0, tau - floor); eta = (theta, 1), or
/// (theta, 1, tau) where tau is given.
std::vector<ScenarioRow> rowsOf(const RobustProgram& program, double floor, bool tau_given) {
  const Eigen::Index nz = program.prediction_count, np = program.parameter_count;
  const Eigen::Index n = nz + 2, h = tau_given ? np + 2 : np + 1;
  std::vector<ScenarioRow> rows;
  for (const RobustProgram::Row& from : program.rows) {
    if (from.kind == RobustProgram::Kind::kBox || from.kind == RobustProgram::Kind::kFloor) continue;
    ScenarioRow row = scenarioRow(from, n, h, n + np);
    row.a[nz] = nearestDouble(from.y[at(program.inputEntry())]);
    row.e.head(np) = -toDoubles(from.y).head(np);
    row.e[np] = nearestDouble(from.bound);
    const double tau = nearestDouble(from.y[at(program.peakEntry())]);
    if (tau_given) {
      row.e[np + 1] = -tau;
    } else {
      row.a[nz + 1] = tau;
      row.e[np] -= tau * floor;
    }
    // a row of theta alone still takes part: 0 <= e . eta
    rows.push_back(std::move(row));
  }
  return rows;
}

RobustProgram withoutBox(RobustProgram program) {
  const auto is_of_box = [](const RobustProgram::Row& row) { return row.kind == RobustProgram::Kind::kBox; };
  program.rows.erase(std::remove_if(program.rows.begin(), program.rows.end(), is_of_box), program.rows.end());
  return program;
}

/// |u~_0 - K e| <= the last variable.
std::vector<ScenarioRow> withDistance(std::vector<ScenarioRow> rows, const Eigen::VectorXd& preferred) {
  const Eigen::Index n = rows.front().a.size(), h = rows.front().e.size();
  for (const double sign : {1.0, -1.0}) {
    ScenarioRow row{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(h), {}};
    row.a[n - 2] = sign;
    row.a[n - 1] = -1.0;
    row.e.head(preferred.size()) = sign * preferred;
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

struct OnlineLp::Parts {
  Parts(const RobustProblem& problem, RobustProgram built)
      : program(std::move(built)),
        whole(withoutBox(program)),
        preferred(at(program.parameter_count)),
        shift(Eigen::VectorXd::Zero(program.parameter_count)),
        floor(problem.floor) {
    const std::vector<int> errors = problem.errorParameters();
    for (int s = 0; s < problem.stateCount(); ++s) preferred[at(errors[at(s)])] = problem.tie_gain(0, s);
    for (int j = 0; j < problem.parameterCount(); ++j) {
      const RobustProblem::Parameter& parameter = problem.parameters[at(j)];
      if (parameter.state < 0) shift[j] = nearestDouble(parameter.input_shift[0]);
    }
    const auto n = static_cast<int>(program.prediction_count) + 2, np = program.parameter_count;
    least_peak = std::make_unique<ScenarioLp>(n, np + 1, rowsOf(program, nearestDouble(floor), false));
    nearest_move = std::make_unique<ScenarioLp>(
        n, np + 2, withDistance(rowsOf(program, 0.0, true), toDoubles(preferred)));
  }

  RobustProgram program;
  IntegerProgram whole;
  RationalVector preferred;
  // Shift of the input by each parameter. Only references shift it.
  Eigen::VectorXd shift;
  Rational floor;
  std::unique_ptr<ScenarioLp> least_peak;
  std::unique_ptr<ScenarioLp> nearest_move;
};

OnlineLp::OnlineLp(const RobustProblem& problem)
    : parts_(std::make_unique<Parts>(problem, buildRobustProgram(problem))) {}
OnlineLp::~OnlineLp() = default;
OnlineLp::OnlineLp(OnlineLp&&) noexcept = default;

const RobustProgram& OnlineLp::program() const { return parts_->program; }

OnlineLp::Answer OnlineLp::solve(const Eigen::VectorXd& theta) {
  const Eigen::Index np = theta.size();
  Eigen::VectorXd eta(np + 1);
  eta << theta, 1.0;
  Answer answer;
  DualSimplex::Status status = parts_->least_peak->solve(eta);
  if (status == DualSimplex::Status::kInfeasible) return answer;
  if (status == DualSimplex::Status::kLimit) throw Error("online program: the simplex method did not end");
  answer.feasible = true;
  const double floor = nearestDouble(parts_->floor);
  answer.peak = floor + parts_->least_peak->objective();
  Eigen::VectorXd fixed(np + 2);
  fixed << eta, answer.peak;
  for (double slack = tolerance::kFirstSlack;; slack *= 10.0) {
    fixed[np + 1] = answer.peak + slack;
    status = parts_->nearest_move->solve(fixed);
    if (status == DualSimplex::Status::kOptimal) break;
    if (slack > 1.0) throw Error("online program: no first move reaches the optimum");
  }
  answer.input = parts_->nearest_move->x()[parts_->program.prediction_count];
  return answer;
}

std::optional<double> OnlineLp::input(const double* theta) {
  const Eigen::VectorXd parameters = Eigen::Map<const Eigen::VectorXd>(theta, parts_->shift.size());
  const Answer answer = solve(parameters);
  if (!answer.feasible) return std::nullopt;
  return answer.input + parts_->shift.dot(parameters);
}

// Starts from one scenario of each row, all signs plus.
OnlineLp::ExactAnswer OnlineLp::solveExactly(const RationalVector& theta) const {
  const IntegerProgram& whole = parts_->whole;
  const HomogeneousPoint fixed = homogeneous(theta);
  ExactScenarioLp online(whole, fixed);
  for (std::size_t i = 0; i < whole.rows().size(); ++i)
    online.add({static_cast<int>(i), std::vector<bool>(whole.rows()[i].terms.size())});
  ExactLp& lp = online.lp();
  const int move = whole.predictionCount(), tau = move + 1;
  lp.setObjective(tau, 1);
  ExactAnswer answer;
  answer.feasible = online.solve();
  if (!answer.feasible) return answer;
  answer.peak = online.entry(parts_->program.peakEntry());
  lp.setColumnBounds(tau, ExactLp::Bound::kFixed, lp.primal(tau), 0);
  lp.setObjective(tau, 0);
  const int distance = lp.addColumns(1);
  lp.setObjective(distance, 1);
  const Rational preferred = dot(parts_->preferred, theta) * fixed[0];
  for (const int sign : {1, -1}) {
    const int row = lp.addRows(1);
    lp.setCoefficient(row, move, sign);
    lp.setCoefficient(row, distance, -1);
    lp.setRowBounds(row, ExactLp::Bound::kUpper, 0, sign * preferred);
  }
  online.solve();
  answer.input = online.entry(parts_->program.inputEntry());
  return answer;
}

}  // namespace polyfly
