#include "explore/region/region_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "explore/region/tolerances.hpp"

namespace polyfly {
namespace {

BuildStatus statusOf(KktSolver::Outcome outcome) {
  switch (outcome) {
    case KktSolver::Outcome::kSolved:
      return BuildStatus::kRegion;
    case KktSolver::Outcome::kDependent:
      return BuildStatus::kDependent;
    case KktSolver::Outcome::kNoOptimum:
      return BuildStatus::kEmptyInterior;
  }
  return BuildStatus::kFailed;
}

// For each row of the program whether it nearly repeats another; empty where none does.
std::vector<char> findNearRows(const NormalisedProgram& program) {
  std::vector<char> result(static_cast<std::size_t>(program.m), 0);
  bool any = false;
  for (int i = 0; i < program.m; ++i) {
    for (int k = 0; k < i; ++k) {
      if ((program.M.row(i) - program.M.row(k)).cwiseAbs().maxCoeff() >= tolerance::kNearRow ||
          (program.D.row(i) - program.D.row(k)).cwiseAbs().maxCoeff() >= tolerance::kNearRow)
        continue;
      result[static_cast<std::size_t>(i)] = result[static_cast<std::size_t>(k)] = 1;
      any = true;
    }
  }
  return any ? result : std::vector<char>();
}

}  // namespace

RegionBuilder::RegionBuilder(const NormalisedProgram& program, double facet_tolerance,
                             double radius_tolerance)
    : program_(program),
      facet_tolerance_(facet_tolerance),
      near_rows_(findNearRows(program)),
      radius_tolerance_(near_rows_.empty() ? radius_tolerance
                                           : std::min(radius_tolerance, tolerance::kNearRowRadius)),
      width_(program.p + 1),
      tables_(program),
      factor_(program, tables_),
      rounded_(makeKktSolver(program, tables_, factor_)),
      accurate_(program),
      kkt_(rounded_.get()),
      reach_((1.0 + tolerance::kBoxMargin) * std::sqrt(static_cast<double>(program.p))),
      is_active_(program.m, 0),
      scratch_(program.p + 1),
      solver_(program.p),
      near_solver_(program.p) {}

// In doubles.
BuildStatus RegionBuilder::solve(const ActiveSet& active) {
  kkt_ = rounded_.get();
  is_cost_rounded_ = false;
  plane_error_ = 0.0;
  doubtful_ = false;
  if (!factor_.factorise(active)) return BuildStatus::kDependent;
  const KktSolver::Outcome outcome = rounded_->solve(active);
  doubtful_ = rounded_->isDoubtful();
  return statusOf(outcome);
}

// Where that fails, the solution in doubles stays.
BuildStatus RegionBuilder::solveAccurately(const ActiveSet& active) {
  const KktSolver::Outcome outcome = accurate_.solve(active);
  if (outcome == KktSolver::Outcome::kSolved) kkt_ = &accurate_;
  is_cost_rounded_ = outcome == KktSolver::Outcome::kDependent;
  return statusOf(outcome);
}

// Adds affine (t, 1) >= 0, known but for `noise`, as a unit half-space. False: the set describes no region.
bool RegionBuilder::addRow(const double* affine, RowOrigin origin, double scale, double noise,
                           BuildStatus& status) {
  double squared = 0.0;
  for (int j = 0; j < program_.p; ++j) squared += affine[j] * affine[j];
  const double length = std::sqrt(squared);
  const bool is_slack = origin.kind == RowOrigin::Kind::kSlack;
  const double flat = (is_slack ? kkt_->constantSlack() : tolerance::kConstantRow) * scale;
  const double constant = affine[program_.p];
  const double blurred = tolerance::kErrorMargin * noise;
  const bool meets_box = std::abs(constant) <= reach_ * (length + blurred) + blurred;
  if (meets_box && noise > flat && length <= blurred) doubtful_ = true;
  if (length <= flat) {
    // Of a row that nearly repeats an active one, only accurate numbers tell where it is violated.
    if (is_slack && std::max(length, -constant) > tolerance::kConstantSlack * scale &&
        constant <= flat + reach_ * length)
      doubtful_ = true;
    if (constant < -flat) {
      status = BuildStatus::kEmptyInterior;
      return false;
    }
    if (origin.kind == RowOrigin::Kind::kMultiplier && constant <= flat) {
      status = BuildStatus::kWeaklyActive;
      return false;
    }
    if (is_slack) nearest_miss_ = std::min(nearest_miss_, constant - reach_ * length);
    return true;
  }
  if (!meets_box) {  // such a row bounds nothing, or all is beyond it; far planes would cost accuracy
    if (constant < 0.0) status = BuildStatus::kEmptyInterior;
    if (is_slack) nearest_miss_ = std::min(nearest_miss_, constant - reach_ * length);
    return constant > 0.0;
  }
  const double inverse = 1.0 / length;
  if (noise > tolerance::kAccurate * length) plane_error_ = std::max(plane_error_, noise * inverse);
  for (int j = 0; j < program_.p; ++j) rows_.push_back(-affine[j] * inverse);
  rows_.push_back(constant * inverse);
  origins_.push_back(origin);
  lengths_.push_back(length);
  return true;
}

// Multipliers of the active rows, their size, and that of the bounds.
void RegionBuilder::startRows(const ActiveSet& active) {
  plane_error_ = 0.0;
  doubtful_ = kkt_->isDoubtful();
  scale_ = 1.0;
  size_ = 0.0;
  multipliers_.resize(active.size() * width_);
  for (std::size_t r = 0; r < active.size(); ++r) {
    kkt_->multiplier(r, multipliers_.data() + r * width_);
    scale_ = std::max(scale_, tables_.D_size[active[r]]);
  }
  for (const double value : multipliers_) size_ = std::max(size_, std::abs(value));
  if (!rounded_->hasCostMultipliers()) return;
  cost_multipliers_.resize(multipliers_.size());
  for (std::size_t r = 0; r < active.size(); ++r)
    kkt_->costMultiplier(r, cost_multipliers_.data() + r * width_);
}

BuildStatus RegionBuilder::addMultiplierRows(const ActiveSet& active) {
  BuildStatus status = BuildStatus::kRegion;
  const double noise = kkt_->noise();
  const bool has_costs = rounded_->hasCostMultipliers();
  const CostScale cost = rounded_->costScale();
  const bool is_exact = kkt_ != rounded_.get();
  for (std::size_t r = 0; r < active.size(); ++r) {
    if (has_costs) {
      const double* cost_multiplier = cost_multipliers_.data() + r * width_;
      double largest = 0.0;
      for (int j = 0; j < width_; ++j) largest = std::max(largest, std::abs(cost_multiplier[j]));
      // The sign of the multiplier is that of the cost multiplier, however small that is without rounding.
      const double zero = is_exact ? 0.0 : cost.zero;
      if (largest > zero) {
        for (int j = 0; j < width_; ++j)
          scratch_[j] = std::abs(cost_multiplier[j]) > zero ? cost_multiplier[j] : 0.0;
        if (!addRow(scratch_.data(), {RowOrigin::Kind::kCostMultiplier, active[r]},
                    is_exact ? largest : cost.scale, noise * largest, status))
          return status;
        continue;
      }
      if (!is_exact && isCostOpen())
        continue;  // only fractions tell whether the cost or the length of z decides
    }
    if (!addRow(multipliers_.data() + r * width_, {RowOrigin::Kind::kMultiplier, active[r]}, scale_,
                noise * size_, status))
      return status;
  }
  return status;
}

BuildStatus RegionBuilder::addSlackRows(const ActiveSet& active) {
  BuildStatus status = BuildStatus::kRegion;
  const double flat = kkt_->constantSlack() * scale_;
  const double noise = kkt_->slackNoise();
  idle_.clear();
  for (const int row : active) is_active_[row] = 1;
  for (int i = 0; i < program_.m && status == BuildStatus::kRegion; ++i) {
    if (is_active_[i]) continue;
    kkt_->slack(i, scratch_.data());
    const std::size_t before = origins_.size();
    addRow(scratch_.data(), {RowOrigin::Kind::kSlack, i}, scale_, noise * (tables_.D_size[i] + size_),
           status);
    if (origins_.size() == before && scratch_[program_.p] <= flat) {
      idle_.push_back(static_cast<std::uint16_t>(i));
    }
  }
  for (const int row : active) is_active_[row] = 0;
  return status;
}

BuildStatus RegionBuilder::assembleRows(const ActiveSet& active) {
  startRows(active);
  rows_.assign(program_.domain.begin(), program_.domain.end());
  origins_.clear();
  for (int d = 0; d < program_.domainCount(); ++d) origins_.push_back({RowOrigin::Kind::kDomain, d});
  lengths_.assign(origins_.size(), 1.0);
  nearest_miss_ = std::numeric_limits<double>::infinity();
  const BuildStatus status = addMultiplierRows(active);
  return status == BuildStatus::kRegion ? addSlackRows(active) : status;
}

// Greatest |entry| of a law over its value at the centre of its region, each at least 1. The values of a steep law are
// small where they count, so its error is no share of its slopes.
double RegionBuilder::steepness(const std::vector<double>& law, const std::vector<double>& centre) {
  double steepest = 1.0;
  for (auto row = law.begin(); row != law.end(); row += static_cast<std::ptrdiff_t>(centre.size()) + 1) {
    double value = row[static_cast<std::ptrdiff_t>(centre.size())], size = std::max(1.0, std::abs(value));
    for (std::size_t j = 0; j < centre.size(); ++j) {
      const double entry = row[static_cast<std::ptrdiff_t>(j)];
      value += entry * centre[j];
      size = std::max(size, std::abs(entry));
    }
    steepest = std::max(steepest, size / std::max(1.0, std::abs(value)));
  }
  return steepest;
}

// Rows, largest ball and law.
BuildStatus RegionBuilder::measure(const ActiveSet& active, Region& region) {
  region.radius = -std::numeric_limits<double>::infinity();
  const BuildStatus status = assembleRows(active);
  if (status != BuildStatus::kRegion) return status;
  region.centre.assign(program_.p, 0.0);
  if (!solver_.chebyshevInBox(rows_.data(), static_cast<int>(origins_.size()), region.centre.data(),
                              region.radius))
    return BuildStatus::kFailed;
  if (region.radius <= radius_tolerance_) return BuildStatus::kEmptyInterior;
  law_error_ = kkt_->law(region.law);
  law_error_ *= steepness(region.law, region.centre);
  return status;
}

bool RegionBuilder::needsAccuracy(BuildStatus status, const Region& region) const {
  if (status == BuildStatus::kDependent) return false;
  if (isIllConditioned()) return true;
  if (status == BuildStatus::kRegion && (isCostOpen() || law_error_ > tolerance::kAccurate)) return true;
  return plane_error_ > tolerance::kAccurate && region.radius > -tolerance::kErrorMargin * plane_error_;
}

BuildStatus RegionBuilder::build(const ActiveSet& active, Region& region) {
  region.radius = -std::numeric_limits<double>::infinity();
  BuildStatus status = solve(active);
  if (status == BuildStatus::kRegion) status = measure(active, region);
  if (needsAccuracy(status, region)) {
    const BuildStatus solved = solveAccurately(active);
    const bool is_rounded = status == BuildStatus::kRegion && is_cost_rounded_;
    if (solved == BuildStatus::kRegion || is_rounded) status = measure(active, region);
    // The doubles found a solution where there is none.
    if (solved == BuildStatus::kEmptyInterior) return solved;
  }
  if (status == BuildStatus::kEmptyInterior && isFlat(region)) return inflateFlat(active, region);
  if (status != BuildStatus::kRegion) return status;
  // A facet of a thin region shows at the region's own scale.
  return findFacets(active, std::min(facet_tolerance_, 0.1 * region.radius), region);
}

// Whether two opposite rows leave nothing between them but for rounding, while others do not keep all out.
bool RegionBuilder::isFlat(const Region& region) const {
  if (rounded_->hasCostMultipliers() || std::abs(region.radius) > tolerance::kFlatness) return false;
  const auto row = [&](int i) {
    return Eigen::Map<const Eigen::VectorXd>(rows_.data() + static_cast<std::size_t>(i) * width_, program_.p);
  };
  const Eigen::Map<const Eigen::VectorXd> centre(region.centre.data(), program_.p);
  std::vector<int> tight;
  for (int i = 0; i < static_cast<int>(origins_.size()); ++i) {
    if (rows_[static_cast<std::size_t>(i) * width_ + program_.p] - row(i).dot(centre) >
        region.radius + tolerance::kFlatness)
      continue;
    if (std::any_of(tight.begin(), tight.end(),
                    [&](int k) { return row(i).dot(row(k)) < tolerance::kOppositeProduct; }))
      return true;
    tight.push_back(i);
  }
  return false;
}

// Where regions meet that nothing but a flat set is between, they are neighbours of its facets.
BuildStatus RegionBuilder::inflateFlat(const ActiveSet& active, Region& region) {
  for (std::size_t i = 0; i < origins_.size(); ++i) rows_[i * width_ + program_.p] += tolerance::kOutwards;
  const BuildStatus status = findFacets(active, facet_tolerance_, region);
  return status == BuildStatus::kRegion ? BuildStatus::kLowerDimensional : status;
}

// Of slacks that nearly repeat each other, a dictionary may lose all digits by which they differ, since it pivots on
// such differences. FloatLp factorises the rows themselves where it stops. Each row is left out in turn if the others
// imply it: first those that they imply but for rounding, since behind them there is nothing, and then the others.
BuildStatus RegionBuilder::decideNearRows(double tolerance) {
  const auto is_near = [&](int row) {
    const RowOrigin& origin = origins_[static_cast<std::size_t>(row)];
    return origin.kind == RowOrigin::Kind::kSlack && near_rows_[static_cast<std::size_t>(origin.index)] != 0;
  };
  const auto p = static_cast<std::size_t>(program_.p);
  std::vector<std::pair<int, std::vector<double>>> left;  // rows with their points beyond
  for (std::size_t f = 0; f < minimal_.facets.size(); ++f) {
    const auto beyond = minimal_.beyond.begin() + static_cast<std::ptrdiff_t>(f * p);
    if (!is_near(minimal_.facets[f]))
      left.emplace_back(minimal_.facets[f], std::vector<double>(beyond, beyond + program_.p));
  }
  for (int i = 0; i < static_cast<int>(origins_.size()); ++i) {
    if (is_near(i)) left.emplace_back(i, std::vector<double>());
  }
  bool failed = false;
  for (const double allowed : {std::min(tolerance::kImpliedNearRow, tolerance), tolerance}) {
    failed = false;
    for (std::size_t k = 0; k < left.size();) {
      if (!is_near(left[k].first) || isNeeded(left, k, allowed, failed)) {
        ++k;
      } else {
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(k));
      }
    }
  }
  if (failed) return BuildStatus::kFailed;
  std::sort(left.begin(), left.end());
  minimal_.facets.clear();
  minimal_.beyond.clear();
  for (const auto& [row, beyond] : left) {
    minimal_.facets.push_back(row);
    minimal_.beyond.insert(minimal_.beyond.end(), beyond.begin(), beyond.end());
  }
  return BuildStatus::kRegion;
}

// Whether a row can be violated by more than the tolerance where all others hold. Its point beyond is then filled in.
// `failed` is set where that remains undecided: there is no point then.
bool RegionBuilder::isNeeded(std::vector<std::pair<int, std::vector<double>>>& left, std::size_t place,
                             double tolerance, bool& failed) {
  const auto row = [&](int i) { return rows_.begin() + static_cast<std::ptrdiff_t>(i) * width_; };
  near_solver_.clear();
  for (const auto& [i, beyond] : left) {
    std::vector<double> half_space(row(i), row(i) + width_);
    if (i == left[place].first) half_space.back() += tolerance::kNearRowReach;
    near_solver_.add(half_space);
  }
  const auto own = row(left[place].first);
  if (near_solver_.maximise(std::vector<double>(own, own + program_.p)) != FloatLp::Status::kOptimal) {
    failed = true;
    return true;
  }
  if (near_solver_.objective() - own[program_.p] <= tolerance) return false;
  left[place].second = near_solver_.x();
  return true;
}

BuildStatus RegionBuilder::findFacets(const ActiveSet& active, double tolerance, Region& region) {
  const int count = static_cast<int>(origins_.size());
  if (!solver_.minimal(rows_.data(), count, region.centre.data(), tolerance, minimal_))
    return BuildStatus::kFailed;
  if (!near_rows_.empty() && decideNearRows(tolerance) != BuildStatus::kRegion) return BuildStatus::kFailed;
  region.tight = active;
  region.tight.insert(region.tight.end(), idle_.begin(), idle_.end());
  std::sort(region.tight.begin(), region.tight.end());
  region.by_slack = std::none_of(origins_.begin(), origins_.end(), [](const RowOrigin& origin) {
    return origin.kind == RowOrigin::Kind::kMultiplier || origin.kind == RowOrigin::Kind::kCostMultiplier;
  });
  region.facets.resize(minimal_.facets.size());
  for (std::size_t f = 0; f < minimal_.facets.size(); ++f) {
    const int row = minimal_.facets[f];
    Facet& facet = region.facets[f];
    facet.origin = origins_[row];
    std::copy_n(rows_.begin() + row * width_, width_, facet.row.begin());
    std::copy_n(minimal_.beyond.begin() + f * program_.p, program_.p, facet.beyond.begin());
  }
  return BuildStatus::kRegion;
}

}  // namespace polyfly
