#include "integer_program.hpp"

#include <algorithm>
#include <utility>

#include "rational_parts.hpp"

namespace polyfly {
namespace {

class Scaler {
 public:
  void include(const Rational& value) {
    mpz_lcm(scale_.get_mpz_t(), scale_.get_mpz_t(), value.get_den_mpz_t());
  }
  void include(const RationalVector& values) {
    for (const Rational& value : values) include(value);
  }
  Integer whole(const Rational& value) const { return value.get_num() * (scale_ / value.get_den()); }
  std::vector<Integer> whole(const RationalVector& values) const {
    std::vector<Integer> result;
    for (const Rational& value : values) result.push_back(whole(value));
    return result;
  }
  const Integer& scale() const { return scale_; }

 private:
  Integer scale_{1};
};

IntegerRow wholeRow(const RobustProgram::Row& row) {
  Scaler scaler;
  scaler.include(row.y);
  scaler.include(row.z);
  scaler.include(row.bound);
  for (const RobustProgram::Term& term : row.terms) {
    scaler.include(term.constant);
    scaler.include(term.z);
  }
  IntegerRow result{scaler.whole(row.y), scaler.whole(row.z), {}, scaler.whole(row.bound), scaler.scale()};
  for (const RobustProgram::Term& term : row.terms)
    result.terms.push_back({scaler.whole(term.constant), scaler.whole(term.z)});
  return result;
}

// sum of row[j] * y[1 + j]
Integer dotPoint(const std::vector<Integer>& row, const HomogeneousPoint& y) {
  Integer sum;
  for (std::size_t j = 0; j < row.size(); ++j)
    mpz_addmul(sum.get_mpz_t(), row[j].get_mpz_t(), y[j + 1].get_mpz_t());
  return sum;
}

}  // namespace

IntegerProgram::IntegerProgram(const RobustProgram& program)
    : law_size_(program.lawSize()), prediction_count_(program.prediction_count) {
  for (const RobustProgram::Row& row : program.rows) rows_.push_back(wholeRow(row));
}

IntegerScenario IntegerProgram::scenario(const Scenario& which) const {
  const IntegerRow& row = rows_[at(which.row)];
  IntegerScenario result{row.z, row.bound};
  for (std::size_t t = 0; t < row.terms.size(); ++t) {
    const IntegerRow::Term& term = row.terms[t];
    const bool negative = which.negative[t];
    if (negative) {
      result.bound += term.constant;
    } else {
      result.bound -= term.constant;
    }
    for (std::size_t j = 0; j < term.z.size(); ++j) {
      if (negative) {
        result.z[j] -= term.z[j];
      } else {
        result.z[j] += term.z[j];
      }
    }
  }
  return result;
}

std::optional<FeasibleSet::Facet> IntegerProgram::combine(const std::vector<Scenario>& scenarios) const {
  if (scenarios.empty()) return std::nullopt;
  std::vector<IntegerScenario> parts;
  for (const Scenario& which : scenarios) parts.push_back(scenario(which));
  // the first weight is 1; the others make the predictions cancel
  const int unknowns = static_cast<int>(parts.size()) - 1;
  std::vector<std::vector<Integer>> rows;
  for (std::size_t j = 0; j < at(prediction_count_); ++j) {
    std::vector<Integer> row;
    for (std::size_t k = 1; k < parts.size(); ++k) row.push_back(parts[k].z[j]);
    row.push_back(-parts[0].z[j]);
    rows.push_back(std::move(row));
  }
  const IntegerSolution solution = solveIntegers(std::move(rows), unknowns);
  if (!solution.consistent || !solution.unique) return std::nullopt;
  RationalVector weights{Rational(solution.x.denominator)};
  for (const Integer& value : solution.x.numerators) {
    if (value < 0) return std::nullopt;
    weights.emplace_back(value);
  }
  return facetOf(scenarios, weights);
}

FeasibleSet::Facet IntegerProgram::facetOf(const std::vector<Scenario>& scenarios,
                                           const RationalVector& weights) const {
  FeasibleSet::Facet facet;
  RationalVector sum(at(law_size_) + 1);
  for (std::size_t k = 0; k < scenarios.size(); ++k) {
    if (weights[k] == 0) continue;
    const IntegerRow& row = rows_[at(scenarios[k].row)];
    for (std::size_t j = 0; j < at(law_size_); ++j) sum[j] += weights[k] * row.y[j];
    sum.back() += weights[k] * scenario(scenarios[k]).bound;
    facet.parts.push_back({scenarios[k].row, scenarios[k].negative, weights[k] * row.scale});
  }
  const std::vector<Integer> whole = wholeNumbers(sum);
  facet.half_space.a.assign(whole.begin(), whole.end() - 1);
  facet.half_space.b = whole.back();
  return facet;
}

std::optional<FeasibleSet::Facet> IntegerProgram::sumOf(const std::vector<FeasibleSet::Part>& parts) const {
  std::vector<Scenario> scenarios;
  RationalVector weights, z(at(prediction_count_));
  for (const FeasibleSet::Part& part : parts) {
    if (part.weight <= 0) return std::nullopt;
    scenarios.push_back({part.row, part.negative});
    weights.push_back(part.weight / rows_[at(part.row)].scale);
    const IntegerScenario whole = scenario(scenarios.back());
    for (std::size_t j = 0; j < z.size(); ++j) z[j] += weights.back() * whole.z[j];
  }
  if (std::any_of(z.begin(), z.end(), [](const Rational& value) { return value != 0; })) return std::nullopt;
  return facetOf(scenarios, weights);
}

// Everything times y[0] * z.denominator.
Integer IntegerProgram::excess(const IntegerRow& row, const HomogeneousPoint& y, const CommonFraction& z,
                               std::vector<bool>* negative) const {
  const Integer common = y[0] * z.denominator;
  Integer sum = dotPoint(row.y, y) * z.denominator + dot(row.z, z.numerators) - row.bound * common;
  for (const IntegerRow::Term& term : row.terms) {
    Integer value = term.constant * common + dot(term.z, z.numerators);
    if (negative != nullptr) negative->push_back(value < 0);
    sum += abs(value);
  }
  return sum;
}

bool IntegerProgram::holds(const HomogeneousPoint& y, const CommonFraction& z) const {
  return std::all_of(rows_.begin(), rows_.end(),
                     [&](const IntegerRow& row) { return excess(row, y, z, nullptr) <= 0; });
}

std::vector<Scenario> IntegerProgram::broken(const HomogeneousPoint& y, const CommonFraction& z) const {
  std::vector<Scenario> result;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Scenario scenario{static_cast<int>(i), {}};
    if (excess(rows_[i], y, z, &scenario.negative) > 0) result.push_back(std::move(scenario));
  }
  return result;
}

CommonFraction IntegerProgram::predictionAt(const HomogeneousPoint& y,
                                            const std::vector<Scenario>& tight) const {
  std::vector<std::vector<Integer>> rows;
  for (const Scenario& which : tight) {
    IntegerScenario part = scenario(which);
    std::vector<Integer> row = std::move(part.z);
    row.push_back(part.bound * y[0] - dotPoint(rows_[at(which.row)].y, y));
    rows.push_back(std::move(row));
  }
  return solveIntegers(std::move(rows), prediction_count_).x;
}

ExactScenarioLp::ExactScenarioLp(const IntegerProgram& program, HomogeneousPoint fixed)
    : program_(program),
      fixed_(std::move(fixed)),
      columns_(program.predictionCount() + program.lawSize() + 1 - static_cast<int>(fixed_.size())) {
  lp_.addColumns(columns_, ExactLp::Bound::kFree);
}

// Everything times y[0].
void ExactScenarioLp::add(const Scenario& which) {
  const IntegerScenario part = program_.scenario(which);
  const IntegerRow& from = program_.rows()[at(which.row)];
  const std::size_t fixed = fixed_.size() - 1;
  const int row = lp_.addRows(1);
  for (int j = 0; j < columns_; ++j) {
    const std::size_t k = at(j), nz = part.z.size();
    const Integer& entry = k < nz ? part.z[k] : from.y[fixed + k - nz];
    if (entry != 0) lp_.setCoefficient(row, j, Rational(entry));
  }
  Integer rest = part.bound * fixed_[0];
  for (std::size_t j = 0; j < fixed; ++j) rest -= from.y[j] * fixed_[j + 1];
  lp_.setRowBounds(row, ExactLp::Bound::kUpper, 0, Rational(rest));
  scenarios_.push_back(which);
}

bool ExactScenarioLp::solve() {
  while (lp_.solve() == ExactLp::Status::kOptimal) {
    Integer common(1);
    const int nz = program_.predictionCount();
    for (int j = 0; j < columns_; ++j)
      mpz_lcm(common.get_mpz_t(), common.get_mpz_t(), lp_.primal(j).get_den_mpz_t());
    const auto whole = [&](int j) { return Integer(Rational(lp_.primal(j) * common).get_num()); };
    HomogeneousPoint y;
    for (const Integer& value : fixed_) y.push_back(value * common);
    for (int j = nz; j < columns_; ++j) y.push_back(whole(j));
    prediction_ = {{}, 1};
    for (int j = 0; j < nz; ++j) prediction_.numerators.push_back(whole(j));
    const std::vector<Scenario> broken = program_.broken(y, prediction_);
    prediction_.denominator = common;
    if (broken.empty()) return true;
    for (const Scenario& which : broken) add(which);
  }
  return false;
}

Rational ExactScenarioLp::entry(int j) const {
  const int column = program_.predictionCount() + j + 1 - static_cast<int>(fixed_.size());
  return lp_.primal(column) / fixed_[0];
}

std::optional<FeasibleSet::Facet> exactCut(const IntegerProgram& program, const HomogeneousPoint& y,
                                           const std::vector<Scenario>& start, CommonFraction& prediction) {
  ExactScenarioLp lp(program, y);
  for (const Scenario& which : start) lp.add(which);
  if (lp.solve()) {
    prediction = lp.prediction();
    return std::nullopt;
  }
  RationalVector weights;
  for (int i = 0; i < lp.lp().rowCount(); ++i) weights.emplace_back(-lp.lp().rowRay(i));
  return program.facetOf(lp.scenarios(), weights);
}

}  // namespace polyfly
