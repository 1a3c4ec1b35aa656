#include "explore/region/region_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "explore/region/tolerances.hpp"

namespace polyfly {
RegionBuilder::RegionBuilder(const NormalisedProgram& program, double facet_tolerance,
                             double radius_tolerance)
    : program_(program),
      facet_tolerance_(facet_tolerance),
      radius_tolerance_(radius_tolerance),
      width_(program.p + 1),
      gram_(static_cast<std::size_t>(program.m) * program.m),
      D_(static_cast<std::size_t>(program.m) * width_),
      M_(static_cast<std::size_t>(program.m) * program.n),
      shortest_(program),
      accurate_(program),
      D_size_(program.m),
      reach_((1.0 + tolerance::kBoxMargin) * std::sqrt(static_cast<double>(program.p))),
      is_active_(program.m, 0),
      scratch_(program.p + 1),
      solver_(program.p) {
  for (int i = 0; i < program.m; ++i) {
    for (int j = 0; j < program.m; ++j)
      gram_[static_cast<std::size_t>(i) * program.m + j] = program.gram(i, j);
    for (int j = 0; j < width_; ++j) D_[static_cast<std::size_t>(i) * width_ + j] = program.D(i, j);
    for (int j = 0; j < program.n; ++j) M_[static_cast<std::size_t>(i) * program.n + j] = program.M(i, j);
    D_size_[i] = program.D.row(i).cwiseAbs().maxCoeff();
  }
  for (int i = 0; i < program.U.rows(); ++i) U_size_.push_back(program.U.row(i).cwiseAbs().maxCoeff());
}

// Adds affine (t, 1) >= 0, known but for `noise`, as a unit half-space. False: the set describes no region.
bool RegionBuilder::addRow(const double* affine, RowOrigin origin, double scale, double noise,
                           BuildStatus& status) {
  double squared = 0.0;
  for (int j = 0; j < program_.p; ++j) squared += affine[j] * affine[j];
  const double length = std::sqrt(squared);
  const bool is_slack = origin.kind == RowOrigin::Kind::kSlack;
  const double flat =
      (is_accurate_ && is_slack ? tolerance::kConstantSlack : tolerance::kConstantRow) * scale;
  if (is_accurate_) noise = 0.0;
  const double constant = affine[program_.p];
  const double blurred = tolerance::kErrorMargin * noise;
  const bool meets_box = std::abs(constant) <= reach_ * (length + blurred) + blurred;
  if (meets_box && noise > flat && length <= blurred) doubtful_ = true;
  if (length <= flat) {
    // Of a row that nearly repeats an active one, only accurate numbers tell where it is violated.
    if (is_slack && std::max(length, -constant) > tolerance::kConstantSlack * scale && constant <= flat)
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

BuildStatus RegionBuilder::addMultiplierRows(const ActiveSet& active, double scale) {
  BuildStatus status = BuildStatus::kRegion;
  double cost_scale = program_.linear ? program_.cost.cwiseAbs().maxCoeff() : 0.0;
  if (program_.semidefinite) {
    for (const double cost_multiplier : cost_multipliers_)
      cost_scale = std::max(cost_scale, std::abs(cost_multiplier));
  }
  // Cost multipliers below this are zero.
  const double zero = program_.linear ? tolerance::kCostResidual * cost_scale : 0.0;
  for (std::size_t r = 0; r < active.size(); ++r) {
    if (program_.linear || program_.semidefinite) {
      const double* cost_multiplier = cost_multipliers_.data() + r * width_;
      const double largest =
          std::abs(*std::max_element(cost_multiplier, cost_multiplier + width_,
                                     [](double a, double b) { return std::abs(a) < std::abs(b); }));
      // The sign of the multiplier is that of the cost multiplier.
      if (largest > zero) {
        for (int j = 0; j < width_; ++j)
          scratch_[j] = std::abs(cost_multiplier[j]) > zero ? cost_multiplier[j] : 0.0;
        if (!addRow(scratch_.data(), {RowOrigin::Kind::kCostMultiplier, active[r]}, cost_scale,
                    growth() * largest, status))
          return status;
        continue;
      }
    }
    if (!addRow(multipliers_.data() + r * width_, {RowOrigin::Kind::kMultiplier, active[r]}, scale,
                growth() * size_, status)) {
      return status;
    }
  }
  return status;
}

// Slack of an inactive row as a function of (t, 1), into scratch_.
void RegionBuilder::slackRow(const ActiveSet& active, int row) {
  if (is_accurate_) return accurate_.slack(row, scratch_.data());
  if (program_.semidefinite) return shortest_.slack(row, scratch_.data());
  const double* gram = gram_.data() + static_cast<std::size_t>(row) * program_.m;
  std::copy_n(D_.data() + static_cast<std::size_t>(row) * width_, width_, scratch_.data());
  for (std::size_t r = 0; r < active.size(); ++r) {
    const double weight = gram[active[r]];
    const double* multiplier = multipliers_.data() + r * width_;
    for (int j = 0; j < width_; ++j) scratch_[j] += weight * multiplier[j];
  }
}

BuildStatus RegionBuilder::addSlackRows(const ActiveSet& active, double scale) {
  BuildStatus status = BuildStatus::kRegion;
  const double flat = (is_accurate_ ? tolerance::kConstantSlack : tolerance::kConstantRow) * scale;
  idle_.clear();
  for (const int row : active) is_active_[row] = 1;
  for (int i = 0; i < program_.m && status == BuildStatus::kRegion; ++i) {
    if (is_active_[i]) continue;
    slackRow(active, i);
    const std::size_t before = origins_.size();
    const double noise = (program_.semidefinite ? growth() : program_.rounding) * (D_size_[i] + size_);
    addRow(scratch_.data(), {RowOrigin::Kind::kSlack, i}, scale, noise, status);
    if (origins_.size() == before && scratch_[program_.p] <= flat) {
      idle_.push_back(static_cast<std::uint16_t>(i));
    }
  }
  for (const int row : active) is_active_[row] = 0;
  return status;
}

BuildStatus RegionBuilder::assembleRows(const ActiveSet& active) {
  double scale = 1.0;
  plane_error_ = 0.0;
  doubtful_ = false;
  if (!findMultipliers(active, scale)) return BuildStatus::kDependent;
  if ((program_.linear || program_.semidefinite) && !findCostMultipliers(active))
    return BuildStatus::kEmptyInterior;

  rows_.assign(program_.domain.begin(), program_.domain.end());
  origins_.clear();
  for (int d = 0; d < program_.domainCount(); ++d) origins_.push_back({RowOrigin::Kind::kDomain, d});
  lengths_.assign(origins_.size(), 1.0);
  nearest_miss_ = std::numeric_limits<double>::infinity();
  const BuildStatus status = addMultiplierRows(active, scale);
  return status == BuildStatus::kRegion ? addSlackRows(active, scale) : status;
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
  law(active, region.law);
  return status;
}

bool RegionBuilder::needsAccuracy(BuildStatus status, const Region& region) const {
  if (status == BuildStatus::kDependent) return false;
  if (isIllConditioned()) return true;
  if (status == BuildStatus::kRegion && law_error_ > tolerance::kAccurate) return true;
  return plane_error_ > tolerance::kAccurate && region.radius > -tolerance::kErrorMargin * plane_error_;
}

bool RegionBuilder::describeAccurately(const ActiveSet& active) {
  is_accurate_ = accurate_.solve(active);
  return is_accurate_;
}

BuildStatus RegionBuilder::build(const ActiveSet& active, Region& region) {
  is_accurate_ = false;
  BuildStatus status = measure(active, region);
  if (needsAccuracy(status, region)) {
    if (describeAccurately(active)) {
      status = measure(active, region);
    } else if (program_.semidefinite && accurate_.isNoSolution()) {
      // The doubles found a solution where there is none.
      return BuildStatus::kEmptyInterior;
    }
  }
  if (status == BuildStatus::kEmptyInterior && isFlat(region)) return inflateFlat(active, region);
  if (status != BuildStatus::kRegion) return status;
  // A facet of a thin region shows at the region's own scale.
  return findFacets(active, std::min(facet_tolerance_, 0.1 * region.radius), region);
}

// Whether two opposite rows leave nothing between them but for rounding, while others do not keep all out.
bool RegionBuilder::isFlat(const Region& region) const {
  if (program_.linear || program_.semidefinite || std::abs(region.radius) > tolerance::kFlatness)
    return false;
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

BuildStatus RegionBuilder::findFacets(const ActiveSet& active, double tolerance, Region& region) {
  const int count = static_cast<int>(origins_.size());
  if (!solver_.minimal(rows_.data(), count, region.centre.data(), tolerance, minimal_))
    return BuildStatus::kFailed;
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

void RegionBuilder::law(const ActiveSet& active, std::vector<double>& out) {
  law_error_ = 0.0;
  if (is_accurate_) return accurate_.law(out);
  if (program_.semidefinite) {
    law_error_ = shortest_.noise();
    return shortest_.law(out);
  }
  const int q = static_cast<int>(program_.U.rows());
  out.resize(static_cast<std::size_t>(q) * width_);
  for (int i = 0; i < q; ++i) {
    double* row = out.data() + static_cast<std::size_t>(i) * width_;
    double size = 1.0, weights = 0.0;
    for (int j = 0; j < width_; ++j) row[j] = program_.U(i, j);
    for (std::size_t r = 0; r < active.size(); ++r) {
      const double weight = program_.V(i, active[r]);
      const double* multiplier = multipliers_.data() + r * width_;
      weights = std::max(weights, std::abs(weight));
      for (int j = 0; j < width_; ++j) row[j] += weight * multiplier[j];
    }
    for (int j = 0; j < width_; ++j) size = std::max(size, std::abs(row[j]));
    law_error_ = std::max(law_error_, program_.rounding * (U_size_[i] + weights * size_) / size);
  }
}

}  // namespace polyfly
