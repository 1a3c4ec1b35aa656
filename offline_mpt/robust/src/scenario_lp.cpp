#include "scenario_lp.hpp"

#include <algorithm>
#include <cmath>

#include "rational_parts.hpp"
#include "tolerances.hpp"

namespace polyfly {
namespace {

constexpr int kMaxRounds = 500;
// Rows per variable that are kept from one solution to the next, at most.
constexpr int kRowsPerVariable = 12;

double greatest(const ScenarioRow& row) {
  double result = row.a.cwiseAbs().maxCoeff();
  for (const ScenarioRow::Term& term : row.terms) result = std::max(result, term.a.cwiseAbs().maxCoeff());
  return result;
}

}  // namespace

ScenarioRow scenarioRow(const RobustProgram::Row& row, Eigen::Index variables, Eigen::Index parameters,
                        Eigen::Index constants) {
  const auto by_z = [&](const RationalVector& z) {
    Eigen::VectorXd a = Eigen::VectorXd::Zero(variables);
    a.head(static_cast<Eigen::Index>(z.size())) = toDoubles(z);
    return a;
  };
  ScenarioRow result{by_z(row.z), Eigen::VectorXd::Zero(parameters), {}};
  for (const RobustProgram::Term& term : row.terms) {
    ScenarioRow::Term to{by_z(term.z), Eigen::VectorXd::Zero(parameters)};
    (constants < variables ? to.a[constants] : to.e[constants - variables]) = nearestDouble(term.constant);
    result.terms.push_back(std::move(to));
  }
  return result;
}

ScenarioLp::ScenarioLp(int variables, int parameters, std::vector<ScenarioRow> rows)
    : n_(variables), rows_(std::move(rows)), simplex_(variables, parameters) {
  for (ScenarioRow& row : rows_) {
    const double scale = greatest(row) > 0.0 ? 1.0 / greatest(row) : 1.0;
    scale_.push_back(scale);
    row.a *= scale;
    row.e *= scale;
    for (ScenarioRow::Term& term : row.terms) {
      term.a *= scale;
      term.e *= scale;
    }
  }
}

void ScenarioLp::add(Scenario scenario) {
  if (tags_.count(scenario) > 0) return;
  const ScenarioRow& row = rows_[static_cast<std::size_t>(scenario.row)];
  Eigen::VectorXd a = row.a, e = row.e;
  for (std::size_t t = 0; t < row.terms.size(); ++t) {
    const double sign = scenario.negative[t] ? -1.0 : 1.0;
    a += sign * row.terms[t].a;
    e -= sign * row.terms[t].e;
  }
  const int tag = static_cast<int>(scenarios_.size());
  simplex_.addRow(tag, a.data(), e.data());
  tags_.emplace(scenario, tag);
  scenarios_.push_back(std::move(scenario));
}

bool ScenarioLp::addViolated(const Eigen::VectorXd& eta) {
  const Eigen::VectorXd point = x();
  const int before = simplex_.rowCount();
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const ScenarioRow& row = rows_[i];
    double excess = row.a.dot(point) - row.e.dot(eta);
    Scenario scenario{static_cast<int>(i), std::vector<bool>(row.terms.size())};
    for (std::size_t t = 0; t < row.terms.size(); ++t) {
      const double value = row.terms[t].a.dot(point) + row.terms[t].e.dot(eta);
      scenario.negative[t] = value < 0.0;
      excess += std::abs(value);
    }
    if (excess > tolerance::kRowViolation) add(std::move(scenario));
  }
  return simplex_.rowCount() > before;
}

DualSimplex::Status ScenarioLp::solve(const Eigen::VectorXd& eta) {
  forget();
  simplex_.setParameters(eta.data());
  DualSimplex::Status status = simplex_.solve();
  for (int round = 0; round < kMaxRounds && status == DualSimplex::Status::kOptimal; ++round) {
    if (!addViolated(eta)) return status;
    status = simplex_.solve();
  }
  return status == DualSimplex::Status::kOptimal ? DualSimplex::Status::kLimit : status;
}

// Scenarios of rows that have been slack lately would only make each pivot longer.
void ScenarioLp::forget() {
  const int limit = kRowsPerVariable * n_;
  if (simplex_.rowCount() <= limit || !simplex_.dropSlackest(limit / 2)) return;
  std::map<Scenario, int> kept;
  for (const int tag : simplex_.tags()) kept.emplace(scenarios_[static_cast<std::size_t>(tag)], tag);
  tags_ = std::move(kept);
}

Eigen::VectorXd ScenarioLp::x() const {
  Eigen::VectorXd result(n_);
  for (int j = 0; j < n_; ++j) result[j] = simplex_.value(j);
  return result;
}

std::vector<ScenarioLp::Tight> ScenarioLp::tight() const {
  std::vector<Tight> result;
  for (const DualSimplex::TightRow& row : simplex_.tight()) {
    const Scenario& scenario = scenarios_[static_cast<std::size_t>(row.tag)];
    result.push_back({scenario, row.multiplier * scale_[static_cast<std::size_t>(scenario.row)]});
  }
  return result;
}

}  // namespace polyfly
