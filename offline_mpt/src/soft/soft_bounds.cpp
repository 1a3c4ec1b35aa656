#include "offline_mpt/soft_bounds.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

#include "lp/polytope.hpp"
#include "offline_mpt/explore.hpp"
#include "soft/active_solution.hpp"
#include "soft/tolerances.hpp"
#include "support/vector_text.hpp"

namespace polyfly {
namespace {

/// An excess up to this is rounding of 0.
double negligibleExcess(const ParametricProgram& program) {
  return tolerance::kNoExcess * std::max(1.0, program.b.size() > 0 ? program.b.cwiseAbs().maxCoeff() : 0.0);
}

/// Six digits, for people.
std::string numberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

/// Greatest values of affine functions over the regions of a partition.
class RegionMaximum {
 public:
  explicit RegionMaximum(const std::vector<Signal>& parameters)
      : solver_(static_cast<int>(parameters.size())),
        middle_(static_cast<Eigen::Index>(parameters.size())),
        half_(middle_.size()),
        lower_(middle_.size()),
        upper_(middle_.size()) {
    for (Eigen::Index j = 0; j < middle_.size(); ++j) {
      const Signal& signal = parameters[static_cast<std::size_t>(j)];
      lower_(j) = signal.lower;
      upper_(j) = signal.upper;
      middle_(j) = 0.5 * (signal.lower + signal.upper);
      half_(j) = 0.5 * (signal.upper - signal.lower);
    }
  }

  void enter(const CriticalRegion& region) {
    const Eigen::Index p = middle_.size();
    rows_.resize(static_cast<std::size_t>(region.G.rows() * (p + 1)));
    for (Eigen::Index i = 0; i < region.G.rows(); ++i) {
      double* row = rows_.data() + i * (p + 1);
      for (Eigen::Index j = 0; j < p; ++j) row[j] = region.G(i, j) * half_(j);
      row[p] = region.g(i) - region.G.row(i).dot(middle_);
    }
    count_ = static_cast<int>(region.G.rows());
    interior_ = (region.centre - middle_).cwiseQuotient(half_);
  }

  /// Raises `greatest` to the maximum of on_theta theta + constant over the region entered last.
  void raise(const Eigen::RowVectorXd& on_theta, double constant, GreatestValue* greatest) {
    Eigen::VectorXd direction = on_theta.transpose().cwiseProduct(half_);
    Eigen::VectorXd theta = middle_ + half_.cwiseProduct(interior_);
    const double length = direction.norm();
    if (length > 0.0) {
      direction /= length;
      Eigen::VectorXd point = interior_;
      if (solver_.support(rows_.data(), count_, interior_.data(), direction.data(), point.data()))
        theta = middle_ + half_.cwiseProduct(point);
    }
    theta = theta.cwiseMax(lower_).cwiseMin(upper_);  // also where the box's edge is rounded
    const double value = on_theta.dot(theta) + constant;
    if (value > greatest->value) *greatest = {value, theta};
  }

 private:
  PolytopeSolver solver_;
  Eigen::VectorXd middle_, half_, lower_, upper_, interior_;
  std::vector<double> rows_;
  int count_ = 0;
};

/// Indices of the bounds by name, in the order of the slacks.
std::vector<SoftBound> namedBounds(const ParametricProgram& program, std::vector<std::size_t>* owner) {
  std::vector<SoftBound> bounds;
  for (const SlackVariable& slack : program.slacks) {
    const double weight = program.f(slack.variable);
    const auto found = std::find_if(bounds.begin(), bounds.end(),
                                    [&](const SoftBound& bound) { return bound.name == slack.name; });
    owner->push_back(static_cast<std::size_t>(found - bounds.begin()));
    if (found == bounds.end()) {
      bounds.push_back({});
      bounds.back().name = slack.name;
      bounds.back().unit = slack.unit;
      bounds.back().linear_weight = weight;
    } else {
      found->linear_weight = std::min(found->linear_weight, weight);
    }
  }
  return bounds;
}

void setExcess(const ParametricProgram& program, const Partition& partition,
               const std::vector<std::size_t>& owner, std::vector<SoftBound>* bounds) {
  RegionMaximum maximum(program.parameters);
  for (const CriticalRegion& region : partition.regions) {
    const ActiveSolution solution = solveActiveSet(program, region.active);
    maximum.enter(region);
    for (std::size_t i = 0; i < owner.size(); ++i) {
      const SlackVariable& slack = program.slacks[i];
      if (std::binary_search(region.active.begin(), region.active.end(), slack.floor)) continue;
      maximum.raise(solution.on_theta.row(slack.variable), solution.constant(slack.variable),
                    &(*bounds)[owner[i]].excess);
    }
  }
  for (SoftBound& bound : *bounds)
    if (bound.excess.value <= negligibleExcess(program)) bound.excess = {};
}

/// Entries of z and rows that stay without the slacks.
struct Kept {
  std::vector<int> variables;
  std::vector<int> rows;
};

Kept keptWithout(const ParametricProgram& program) {
  std::vector<char> drop_variable(static_cast<std::size_t>(program.variableCount()), 0);
  std::vector<char> drop_row(static_cast<std::size_t>(program.rowCount()), 0);
  for (const SlackVariable& slack : program.slacks) {
    drop_variable[static_cast<std::size_t>(slack.variable)] = 1;
    if (slack.floor >= 0) drop_row[static_cast<std::size_t>(slack.floor)] = 1;
  }
  Kept kept;
  for (int i = 0; i < program.variableCount(); ++i)
    if (drop_variable[static_cast<std::size_t>(i)] == 0) kept.variables.push_back(i);
  for (int i = 0; i < program.rowCount(); ++i)
    if (drop_row[static_cast<std::size_t>(i)] == 0) kept.rows.push_back(i);
  return kept;
}

Eigen::MatrixXd part(const Eigen::MatrixXd& matrix, const std::vector<int>& rows,
                     const std::vector<int>& columns) {
  Eigen::MatrixXd result(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns.size()));
  for (Eigen::Index i = 0; i < result.rows(); ++i)
    for (Eigen::Index j = 0; j < result.cols(); ++j)
      result(i, j) = matrix(rows[static_cast<std::size_t>(i)], columns[static_cast<std::size_t>(j)]);
  return result;
}

std::vector<int> upTo(Eigen::Index count) {
  std::vector<int> indices;
  for (int i = 0; i < count; ++i) indices.push_back(i);
  return indices;
}

/// False where the active set of a region has no unique multipliers.
bool raiseMultipliers(const ParametricProgram& program, const ParametricProgram& hard,
                      const Partition& partition, const std::vector<std::size_t>& owner,
                      std::vector<SoftBound>* bounds) {
  const Kept kept = keptWithout(program);
  std::map<int, std::size_t> slack_of_row;
  for (std::size_t i = 0; i < program.slacks.size(); ++i)
    for (const int row : program.slacks[i].rows) slack_of_row[row] = i;
  RegionMaximum maximum(program.parameters);
  bool unique = true;
  for (const CriticalRegion& region : partition.regions) {
    const ActiveSolution solution = solveActiveSet(hard, region.active);
    unique = unique && solution.independent;
    maximum.enter(region);
    std::map<std::size_t, std::pair<Eigen::RowVectorXd, double>> sums;
    for (std::size_t k = 0; k < region.active.size(); ++k) {
      const auto found = slack_of_row.find(kept.rows[static_cast<std::size_t>(region.active[k])]);
      if (found == slack_of_row.end()) continue;
      const auto at = static_cast<Eigen::Index>(hard.variableCount()) + static_cast<Eigen::Index>(k);
      auto [sum, added] = sums.insert({found->second, {solution.on_theta.row(at), solution.constant(at)}});
      if (added) continue;
      sum->second.first += solution.on_theta.row(at);
      sum->second.second += solution.constant(at);
    }
    for (const auto& [slack, sum] : sums)
      maximum.raise(sum.first, sum.second, &(*bounds)[owner[slack]].multiplier);
  }
  return unique;
}

void setExactness(const ParametricProgram& program, const ExploreOptions& options,
                  const std::vector<std::size_t>& owner, std::vector<SoftBound>* bounds) {
  const ParametricProgram hard = withHardBounds(program);
  const Partition partition = explore(hard, options);
  const bool never = partition.status == ExploreStatus::kInfeasible;
  const bool complete = partition.status == ExploreStatus::kComplete;
  const bool unique = complete && raiseMultipliers(program, hard, partition, owner, bounds);
  for (SoftBound& bound : *bounds) {
    if (never) bound.exactness = SoftBound::Exactness::kNeverFeasible;
    if (!unique) continue;
    const bool below = bound.multiplier.value <= bound.linear_weight * (1.0 + tolerance::kWeightTolerance);
    bound.exactness = below ? SoftBound::Exactness::kExact : SoftBound::Exactness::kNotExact;
  }
}

}  // namespace

ParametricProgram withHardBounds(const ParametricProgram& program) {
  const Kept kept = keptWithout(program);
  const std::vector<int> parameters = upTo(program.parameterCount());
  ParametricProgram hard = program;
  hard.slacks.clear();
  hard.H = part(program.H, kept.variables, kept.variables);
  hard.f = part(program.f, kept.variables, {0});
  hard.F = part(program.F, kept.variables, parameters);
  hard.A = part(program.A, kept.rows, kept.variables);
  hard.b = part(program.b, kept.rows, {0});
  hard.S = part(program.S, kept.rows, parameters);
  hard.E = part(program.E, upTo(program.E.rows()), kept.variables);
  hard.row_names.clear();
  hard.equalities.clear();
  for (std::size_t i = 0; i < kept.rows.size(); ++i) {
    const int row = kept.rows[i];
    if (!program.row_names.empty())
      hard.row_names.push_back(program.row_names[static_cast<std::size_t>(row)]);
    if (std::count(program.equalities.begin(), program.equalities.end(), row) > 0)
      hard.equalities.push_back(static_cast<int>(i));
  }
  return hard;
}

std::vector<SoftBound> softBounds(const ParametricProgram& program, const Partition& partition,
                                  ExploreOptions options) {
  std::vector<std::size_t> owner;
  std::vector<SoftBound> bounds = namedBounds(program, &owner);
  if (bounds.empty()) return bounds;
  setExcess(program, partition, owner, &bounds);
  options.checkpoint.clear();
  options.resume = false;
  options.group = nullptr;
  setExactness(program, options, owner, &bounds);
  return bounds;
}

std::string softBoundText(const SoftBound& bound) {
  std::string text = "soft bound " + bound.name + ": ";
  text += bound.excess.value > 0.0
              ? "exceeded by at most " + numberText(bound.excess.value) + " " + bound.unit +
                    " in a prediction, at theta = " + vectorText(bound.excess.theta)
              : std::string("never exceeded in a prediction");
  const std::string weight = "; linear weight " + numberText(bound.linear_weight);
  const std::string greatest = numberText(bound.multiplier.value);
  switch (bound.exactness) {
    case SoftBound::Exactness::kExact:
      return text + weight + " is exact, above the greatest multiplier " + greatest + " of the hard bound";
    case SoftBound::Exactness::kNotExact:
      return text + weight + " is not exact: the hard bound has the multiplier " + greatest +
             " at theta = " + vectorText(bound.multiplier.theta);
    case SoftBound::Exactness::kNeverFeasible:
      return text + "; with hard bounds no parameter of the box has a solution";
    case SoftBound::Exactness::kUnknown:
      break;
  }
  return text + weight + ": whether it is exact is not decided";
}

}  // namespace polyfly
