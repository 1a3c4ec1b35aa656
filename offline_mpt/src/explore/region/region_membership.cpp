#include <algorithm>
#include <cmath>

#include "explore/region/region_builder.hpp"
#include "explore/region/tolerances.hpp"

namespace polyfly {
bool RegionBuilder::holds(const ActiveSet& active, const double* t, double tolerance) {
  const BuildStatus solved = solve(active);
  if (solved == BuildStatus::kDependent) return false;
  const bool held = solved == BuildStatus::kRegion && holdsAsSolved(active, t, tolerance);
  if (!isIllConditioned() && !(held && isCostOpen()) && plane_error_ <= tolerance::kAccurate) return held;
  if (!held && !isIllConditioned() &&
      !holdsAsSolved(active, t, tolerance + tolerance::kErrorMargin * plane_error_))
    return false;
  const BuildStatus accurate = solveAccurately(active);
  if (accurate == BuildStatus::kEmptyInterior) return false;
  const bool is_rounded = held && is_cost_rounded_;
  return accurate == BuildStatus::kRegion || is_rounded ? holdsAsSolved(active, t, tolerance) : held;
}

bool RegionBuilder::holdsAsSolved(const ActiveSet& active, const double* t, double tolerance) {
  startRows(active);
  clearRows();
  if (addMultiplierRows(active) != BuildStatus::kRegion || !satisfied(t, tolerance)) return false;
  return holdsSlacks(active, t, tolerance);
}

void RegionBuilder::clearRows() {
  rows_.clear();
  origins_.clear();
  lengths_.clear();
}

// Whether t satisfies the rows gathered so far but for `tolerance`.
bool RegionBuilder::satisfied(const double* t, double tolerance) const {
  for (std::size_t i = 0; i < origins_.size(); ++i) {
    double slack = rows_[i * width_ + program_.p];
    for (int j = 0; j < program_.p; ++j) slack -= rows_[i * width_ + j] * t[j];
    if (slack < -tolerance) return false;
  }
  return true;
}

// The same of the inactive rows. Their slacks at t alone clear most of them; only the others are described as
// half-spaces.
bool RegionBuilder::holdsSlacks(const ActiveSet& active, const double* t, double tolerance) {
  at_point_.resize(active.size());
  for (std::size_t r = 0; r < active.size(); ++r) at_point_[r] = valueOf(multipliers_.data() + r * width_, t);
  clearRows();
  for (const int row : active) is_active_[row] = 1;
  BuildStatus status = BuildStatus::kRegion;
  for (int i = 0; i < program_.m && status == BuildStatus::kRegion; ++i) {
    if (is_active_[i]) continue;
    const double* gram = tables_.products(i);
    double slack = valueOf(tables_.bound(i), t);
    for (std::size_t r = 0; r < active.size(); ++r) slack += gram[active[r]] * at_point_[r];
    const double size = tables_.D_size[i] + size_;
    const double noise = program_.rounding * size;
    if (slack > tolerance::kClearSlack * scale_ + tolerance::kErrorMargin * noise) continue;
    kkt_->slack(i, scratch_.data());
    addRow(scratch_.data(), {RowOrigin::Kind::kSlack, i}, scale_, kkt_->slackNoise() * size, status);
  }
  for (const int row : active) is_active_[row] = 0;
  return status == BuildStatus::kRegion && satisfied(t, tolerance);
}

}  // namespace polyfly
