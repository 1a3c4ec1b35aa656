#include <algorithm>
#include <cmath>
#include <limits>

#include "explore/region/region_builder.hpp"
#include "explore/region/tolerances.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kCoincidentLimit = 6;  // rows in one facet whose combinations are all tried

ActiveSet with(const ActiveSet& active, int row) {
  ActiveSet result = active;
  result.insert(std::upper_bound(result.begin(), result.end(), row), static_cast<std::uint16_t>(row));
  return result;
}

ActiveSet without(const ActiveSet& active, int row) {
  ActiveSet result = active;
  result.erase(std::remove(result.begin(), result.end(), row), result.end());
  return result;
}

RowSpan spanOf(const ActiveSet& active) { return {active.data(), active.size()}; }

}  // namespace

double crossingFraction(const Region& region, const Facet& facet) {
  const std::size_t p = region.centre.size();
  double inside = facet.row[p];
  double outside = facet.row[p];
  for (std::size_t j = 0; j < p; ++j) {
    inside -= facet.row[j] * region.centre[j];
    outside -= facet.row[j] * facet.beyond[j];
  }
  return inside / (inside - outside);
}

// Rows whose plane is the facet's, into changes_.
void RegionBuilder::findChanges(const Facet& facet) {
  changes_.clear();
  for (std::size_t i = 0; i < origins_.size(); ++i) {
    int j = 0;
    while (j < width_ && std::abs(rows_[i * width_ + j] - facet.row[j]) <= tolerance::kSameFacet) ++j;
    if (j == width_) changes_.push_back(static_cast<int>(i));
  }
}

// Where the way from the centre to the point beyond the facet crosses it, and what the multipliers are there.
void RegionBuilder::cross(const ActiveSet& active, const Region& region, const Facet& facet) {
  const double fraction = crossingFraction(region, facet);
  crossing_ = region.centre;
  for (std::size_t j = 0; j < crossing_.size(); ++j)
    crossing_[j] += fraction * (facet.beyond[j] - crossing_[j]);
  at_point_.resize(active.size());
  for (std::size_t r = 0; r < active.size(); ++r)
    at_point_[r] = valueOf(multipliers_.data() + r * width_, crossing_.data());
}

// A row that depends on the active ones can only join where one of them leaves. With row = sum w_j active_j,
// raising its multiplier lowers those with w_j > 0. If there are none, the program is infeasible beyond the
// facet. Constant cost multipliers tell which row leaves first: those of least cost multiplier / w_j.
// Otherwise the row leaves first whose multiplier reaches zero first at the crossing. Returns its place in
// `active`, or -1.
int RegionBuilder::exchange(const ActiveSet& active, int row, ActiveSetList& sets) const {
  const std::vector<double>& weights = factor_.weights();
  const auto cost_multiplier = [&](std::size_t r) {
    return cost_multipliers_[r * width_ + program_.p] / weights[r];
  };
  const bool constant_costs = rounded_->hasConstantCosts();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t r = 0; constant_costs && r < active.size(); ++r) {
    if (weights[r] > tolerance::kExchangeWeight) least = std::min(least, cost_multiplier(r));
  }
  if (constant_costs) least += tolerance::kCostResidual * (1.0 + std::abs(least));
  const auto leaves = [&](std::size_t r) {
    return weights[r] > tolerance::kExchangeWeight && (!constant_costs || cost_multiplier(r) <= least);
  };
  int first = -1;
  double goes_at = std::numeric_limits<double>::infinity();
  for (std::size_t r = 0; r < active.size(); ++r) {
    if (!leaves(r) || (first >= 0 && at_point_[r] / weights[r] >= goes_at)) continue;
    first = static_cast<int>(r);
    goes_at = at_point_[r] / weights[r];
  }
  if (first >= 0) sets.push(spanOf(active), active[first], row);
  for (std::size_t r = 0; r < active.size(); ++r) {
    if (leaves(r) && static_cast<int>(r) != first) sets.push(spanOf(active), active[r], row);
  }
  return first;
}

// Whether the set with the facet's row in the place of the one that goes first is optimal just behind the
// crossing, with room to spare for what rounding does. With G the products of the active rows and sigma the
// slack of the facet's row, w_j the weight of row j, which leaves, its multipliers are those of
// lambda - sigma G^-1 e_j / w_j, moved until that of row j is zero; sigma is zero in the facet.
bool RegionBuilder::beginsBehind(const ActiveSet& active, int leaving) {
  if (!kkt_->foreseesChanges() || doubtful_ || !idle_.empty()) return false;
  const std::vector<double>& weights = factor_.weights();
  if (factor_.pivot() < tolerance::kSoundPivot || plane_error_ > tolerance::kAccurate ||
      weights[leaving] < tolerance::kSoundPivot)
    return false;
  const std::size_t k = active.size();
  column_.assign(k, 0.0);
  column_[leaving] = 1.0;
  factor_.solve(column_.data(), 1);
  double greatest = 0.0, total = 0.0;
  for (const double entry : column_) {
    greatest = std::max(greatest, std::abs(entry));
    total += std::abs(entry);
  }
  const double weight = weights[leaving];
  const double steepness = lengths_[changes_.front()] / weight;
  const double multipliers_change = tolerance::kRoomBehind * (reach_ * size_ + steepness * greatest);
  const double step = at_point_[leaving] / weight;
  if (at_point_[leaving] < multipliers_change) return false;
  for (std::size_t r = 0; r < k; ++r) {
    if (static_cast<int>(r) == leaving) continue;
    if (at_point_[r] - step * weights[r] < (1.0 + std::abs(weights[r]) / weight) * multipliers_change)
      return false;
  }
  return slacksStay(changes_.front(), tolerance::kRoomBehind * steepness * total);
}

// Whether the box's half-spaces and the slacks but that of `facet` are farther from zero at the crossing than
// they change there, by as much as here and `change` more, in units of their own.
bool RegionBuilder::slacksStay(int facet, double change) const {
  if (nearest_miss_ < change) return false;
  for (std::size_t i = 0; i < origins_.size(); ++i) {
    const RowOrigin::Kind kind = origins_[i].kind;
    if (kind == RowOrigin::Kind::kMultiplier || static_cast<int>(i) == facet) continue;
    const double* row = rows_.data() + i * width_;
    double room = row[program_.p];
    for (int j = 0; j < program_.p; ++j) room -= row[j] * crossing_[j];
    const double needed = kind == RowOrigin::Kind::kDomain ? tolerance::kRoomBehind
                                                           : tolerance::kRoomBehind + change / lengths_[i];
    if (room < needed) return false;
  }
  return true;
}

double RegionBuilder::valueOf(const double* affine, const double* t) const {
  double value = affine[program_.p];
  for (int j = 0; j < program_.p; ++j) value += affine[j] * t[j];
  return value;
}

Crossing RegionBuilder::neighbours(const ActiveSet& active, const Region& region, const Facet& facet,
                                   ActiveSetList& sets) {
  if (facet.origin.kind == RowOrigin::Kind::kDomain) return Crossing::kBoundary;
  findChanges(facet);
  const bool at_border = std::any_of(changes_.begin(), changes_.end(),
                                     [&](int row) { return origins_[row].kind == RowOrigin::Kind::kDomain; });
  if (at_border) return Crossing::kBoundary;
  const RowSpan all = spanOf(active);
  const int index = facet.origin.index;
  if (facet.origin.kind == RowOrigin::Kind::kCostMultiplier)
    return rounded_->crossCostFacet(active, index, sets) ? Crossing::kDegenerate : Crossing::kBoundary;
  if (changes_.size() > 1) {
    cross(active, region, facet);
    combine(active, sets);
    return Crossing::kDegenerate;
  }
  Crossing crossing = Crossing::kSingle;
  if (facet.origin.kind == RowOrigin::Kind::kMultiplier) {
    sets.push(all, index);
  } else if (!depends(active, index)) {
    sets.push(all, ActiveSetList::kNone, index);
  } else {
    cross(active, region, facet);
    const int leaving = exchange(active, index, sets);
    if (leaving < 0) return Crossing::kBoundary;
    crossing = beginsBehind(active, leaving) ? Crossing::kExchange : Crossing::kDegenerate;
  }
  // Rows that are tight all over the region without a multiplier may get one beyond the facet.
  return idle_.empty() ? crossing : Crossing::kDegenerate;
}

// Several rows change at once in the facet: every combination of the changes is a candidate, and every
// exchange.
void RegionBuilder::combine(const ActiveSet& active, ActiveSetList& sets) {
  const std::size_t count = std::min(changes_.size(), kCoincidentLimit);
  for (std::size_t subset = 1; subset < (std::size_t{1} << count); ++subset) {
    ActiveSet candidate = active;
    for (std::size_t c = 0; c < count; ++c) {
      if ((subset >> c & 1u) == 0) continue;
      const RowOrigin& change = origins_[changes_[c]];
      candidate = change.kind == RowOrigin::Kind::kSlack ? with(candidate, change.index)
                                                         : without(candidate, change.index);
    }
    sets.push(spanOf(candidate));
  }
  for (std::size_t c = 0; c < count; ++c) {
    const RowOrigin& change = origins_[changes_[c]];
    if (change.kind == RowOrigin::Kind::kSlack && depends(active, change.index))
      exchange(active, change.index, sets);
  }
}

}  // namespace polyfly
