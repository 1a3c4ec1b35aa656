#include "robust_mpc/online_lp.hpp"

#include <utility>

#include "integer_program.hpp"
#include "offline_mpt/exact_lp.hpp"
#include "polyfly_base/error.hpp"
#include "rational_parts.hpp"
#include "tolerances.hpp"

namespace polyfly {
namespace {

Eigen::VectorXd rounded(const Rational* first, Eigen::Index count) {
  Eigen::VectorXd result(count);
  for (Eigen::Index j = 0; j < count; ++j) result[j] = nearestDouble(first[j]);
  return result;
}

/// Rows in x = (z, u~_0, tau, distance) or, without a distance, (z, u~_0, tau - floor); eta = (theta, 1), or
/// (theta, 1, tau) where tau is given.
std::vector<ScenarioRow> rowsOf(const RobustProgram& program, double floor, bool tau_given) {
  const Eigen::Index nz = program.prediction_count, np = program.parameter_count;
  const Eigen::Index n = nz + 2, h = tau_given ? np + 2 : np + 1;
  std::vector<ScenarioRow> rows;
  for (const RobustProgram::Row& from : program.rows) {
    if (from.kind == RobustProgram::Kind::kBox || from.kind == RobustProgram::Kind::kFloor) continue;
    ScenarioRow row{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(h), {}};
    row.a.head(nz) = rounded(from.z.data(), nz);
    row.a[nz] = nearestDouble(from.y[at(program.inputEntry())]);
    row.e.head(np) = -rounded(from.y.data(), np);
    row.e[np] = nearestDouble(from.bound);
    const double tau = nearestDouble(from.y[at(program.peakEntry())]);
    if (tau_given) {
      row.e[np + 1] = -tau;
    } else {
      row.a[nz + 1] = tau;
      row.e[np] -= tau * floor;
    }
    for (const RobustProgram::Term& term : from.terms) {
      ScenarioRow::Term to{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(h)};
      to.a.head(nz) = rounded(term.z.data(), nz);
      to.e[np] = nearestDouble(term.constant);
      row.terms.push_back(std::move(to));
    }
    // a row of theta alone still takes part: 0 <= e . eta
    rows.push_back(std::move(row));
  }
  return rows;
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
        whole(program),
        preferred(at(program.parameter_count)),
        floor(problem.floor) {
    const std::vector<int> errors = problem.errorParameters();
    for (int s = 0; s < problem.stateCount(); ++s) preferred[at(errors[at(s)])] = problem.tie_gain(0, s);
    const auto n = static_cast<int>(program.prediction_count) + 2, np = program.parameter_count;
    least_peak = std::make_unique<ScenarioLp>(n, np + 1, rowsOf(program, nearestDouble(floor), false));
    const Eigen::VectorXd gain = rounded(preferred.data(), np);
    nearest_move = std::make_unique<ScenarioLp>(n, np + 2, withDistance(rowsOf(program, 0.0, true), gain));
  }

  RobustProgram program;
  IntegerProgram whole;
  RationalVector preferred;
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

namespace {

/// min tau, or with a given tau min |u~_0 - preferred|, over columns z, u~_0, tau, distance.
class ExactOnline {
 public:
  ExactOnline(const RobustProgram& program, const IntegerProgram& whole, const RationalVector& theta)
      : program_(program), whole_(whole), theta_(theta), nz_(program.prediction_count) {
    lp_.addColumns(nz_ + 3);
    for (int j = 0; j < nz_ + 2; ++j) lp_.setColumnBounds(j, ExactLp::Bound::kFree, Rational(0), Rational(0));
    lp_.setColumnBounds(nz_ + 2, ExactLp::Bound::kLower, Rational(0), Rational(0));
    // start from one scenario of each row, all signs plus
    for (std::size_t i = 0; i < program.rows.size(); ++i) {
      if (program.rows[i].kind != RobustProgram::Kind::kBox)
        add(Scenario{static_cast<int>(i), std::vector<bool>(program.rows[i].terms.size())});
    }
  }

  void minimisePeak() { lp_.setObjective(nz_ + 1, Rational(1)); }

  void minimiseDistance(const Rational& peak, const Rational& preferred) {
    lp_.setObjective(nz_ + 1, Rational(0));
    lp_.setObjective(nz_ + 2, Rational(1));
    lp_.setColumnBounds(nz_ + 1, ExactLp::Bound::kFixed, peak, peak);
    for (const int sign : {1, -1}) {
      const int row = lp_.addRows(1);
      lp_.setCoefficient(row, nz_, Rational(sign));
      lp_.setCoefficient(row, nz_ + 2, Rational(-1));
      lp_.setRowBounds(row, ExactLp::Bound::kUpper, Rational(0), sign * preferred);
    }
  }

  /// False: infeasible.
  bool solve() {
    while (lp_.solve() == ExactLp::Status::kOptimal) {
      const std::vector<Scenario> broken = brokenScenarios();
      if (broken.empty()) return true;
      for (const Scenario& which : broken) add(which);
    }
    return false;
  }

  const Rational& peak() const { return lp_.primal(nz_ + 1); }
  const Rational& input() const { return lp_.primal(nz_); }

 private:
  void add(const Scenario& which) {
    const IntegerScenario part = whole_.scenario(which);
    const IntegerRow& from = whole_.rows()[at(which.row)];
    const int row = lp_.addRows(1);
    for (int j = 0; j < nz_; ++j) {
      if (part.z[at(j)] != 0) lp_.setCoefficient(row, j, Rational(part.z[at(j)]));
    }
    lp_.setCoefficient(row, nz_, Rational(from.y[at(program_.inputEntry())]));
    lp_.setCoefficient(row, nz_ + 1, Rational(from.y[at(program_.peakEntry())]));
    Rational bound(part.bound);
    for (std::size_t j = 0; j < theta_.size(); ++j) bound -= from.y[j] * theta_[j];
    lp_.setRowBounds(row, ExactLp::Bound::kUpper, Rational(0), bound);
  }

  std::vector<Scenario> brokenScenarios() const {
    RationalVector y = theta_, z;
    y.push_back(input());
    y.push_back(peak());
    for (int j = 0; j < nz_; ++j) z.push_back(lp_.primal(j));
    std::vector<Scenario> result;
    for (std::size_t i = 0; i < program_.rows.size(); ++i) {
      const RobustProgram::Row& row = program_.rows[i];
      if (row.kind == RobustProgram::Kind::kBox || rowExcess(row, y, z) <= 0) continue;
      Scenario which{static_cast<int>(i), {}};
      for (const RobustProgram::Term& term : row.terms)
        which.negative.push_back(term.constant + dot(term.z, z) < 0);
      result.push_back(std::move(which));
    }
    return result;
  }

  const RobustProgram& program_;
  const IntegerProgram& whole_;
  const RationalVector& theta_;
  int nz_;
  ExactLp lp_;
};

}  // namespace

OnlineLp::ExactAnswer OnlineLp::solveExactly(const RationalVector& theta) const {
  ExactOnline online(parts_->program, parts_->whole, theta);
  online.minimisePeak();
  ExactAnswer answer;
  if (!online.solve()) return answer;
  answer.feasible = true;
  answer.peak = online.peak();
  online.minimiseDistance(answer.peak, dot(parts_->preferred, theta));
  online.solve();
  answer.input = online.input();
  return answer;
}

}  // namespace polyfly
