#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "region_builder.hpp"

namespace polyfly {
namespace {

constexpr double kCoincident = 1e-9;         // difference below which two unit half-spaces are the same plane
constexpr double kExchange = 1e-9;           // weight above which a row can leave in an exchange
constexpr std::size_t kCoincidentLimit = 6;  // rows in one facet whose combinations are all tried

ActiveSet with(const ActiveSet& active, int row) {
  ActiveSet result = active;
  result.insert(std::upper_bound(result.begin(), result.end(), row), static_cast<std::uint16_t>(row));
  return result;
}

/// With `row` in the place of another one.
ActiveSet exchanged(const ActiveSet& active, int leaving, int row) {
  ActiveSet result;
  result.reserve(active.size());
  bool placed = false;
  for (const std::uint16_t kept : active) {
    if (kept == leaving) continue;
    if (!placed && kept > row) {
      result.push_back(static_cast<std::uint16_t>(row));
      placed = true;
    }
    result.push_back(kept);
  }
  if (!placed) result.push_back(static_cast<std::uint16_t>(row));
  return result;
}

ActiveSet without(const ActiveSet& active, int row) {
  ActiveSet result = active;
  result.erase(std::remove(result.begin(), result.end(), row), result.end());
  return result;
}

std::vector<double> crossingPoint(const RegionData& region, const Facet& facet) {
  const double fraction = crossingFraction(region, facet);
  std::vector<double> point = region.centre;
  for (std::size_t j = 0; j < point.size(); ++j) point[j] += fraction * (facet.beyond[j] - point[j]);
  return point;
}

}  // namespace

double crossingFraction(const RegionData& region, const Facet& facet) {
  double inside = facet.row.back();
  double outside = facet.row.back();
  for (std::size_t j = 0; j < region.centre.size(); ++j) {
    inside -= facet.row[j] * region.centre[j];
    outside -= facet.row[j] * facet.beyond[j];
  }
  return inside / (inside - outside);
}

// Rows whose plane is the facet's.
std::vector<RowOrigin> RegionBuilder::coincident(const Facet& facet) const {
  std::vector<RowOrigin> result;
  for (std::size_t i = 0; i < origins_.size(); ++i) {
    int j = 0;
    while (j < width_ && std::abs(rows_[i * width_ + j] - facet.row[j]) <= kCoincident) ++j;
    if (j == width_) result.push_back(origins_[i]);
  }
  return result;
}

// Whether `row` lies in the span of the active rows, and its weights there.
bool RegionBuilder::depends(const ActiveSet& active, int row, std::vector<double>& weights) const {
  const int k = static_cast<int>(active.size());
  const double* gram = gram_.data() + static_cast<std::size_t>(row) * program_.m;
  weights.resize(k);
  double squared = gram[row];
  for (int r = 0; r < k; ++r) {
    double value = gram[active[r]];
    for (int c = 0; c < r; ++c) value -= factor_[static_cast<std::size_t>(r) * k + c] * weights[c];
    weights[r] = value / factor_[static_cast<std::size_t>(r) * k + r];
    squared -= weights[r] * weights[r];
  }
  for (int r = k - 1; r >= 0; --r) {
    double value = weights[r];
    for (int c = r + 1; c < k; ++c) value -= factor_[static_cast<std::size_t>(c) * k + r] * weights[c];
    weights[r] = value / factor_[static_cast<std::size_t>(r) * k + r];
  }
  if (squared > kSafePivot) return false;
  Eigen::VectorXd rest = program_.M.row(row);
  for (int r = 0; r < k; ++r) rest -= weights[r] * program_.M.row(active[r]).transpose();
  return rest.norm() <= kIndependent;
}

// `row` depends on the active rows: it can only join where one of them leaves. With row = sum w_j active_j,
// raising its multiplier lowers those with w_j > 0; if there are none, the program is infeasible beyond the
// facet. Constant prices tell which goes first: those of least price / w_j. Of the others, whose multipliers
// tell it at each place, that which goes first at `crossing` comes first.
void RegionBuilder::exchange(const ActiveSet& active, int row, const std::vector<double>& crossing,
                             std::vector<ActiveSet>& sets) const {
  std::vector<double> weights;
  if (!depends(active, row, weights)) return;
  const bool constant_prices =
      program_.linear && program_.cost.leftCols(program_.p).cwiseAbs().maxCoeff() == 0.0;
  double least = 0.0;
  if (constant_prices) {
    least = std::numeric_limits<double>::infinity();
    for (std::size_t r = 0; r < active.size(); ++r) {
      if (weights[r] > kExchange) least = std::min(least, prices_[r * width_ + program_.p] / weights[r]);
    }
    least += kUnpaid * (1.0 + std::abs(least));
  }
  double first = std::numeric_limits<double>::infinity();
  const std::size_t before = sets.size();
  for (std::size_t r = 0; r < active.size(); ++r) {
    if (weights[r] <= kExchange) continue;
    if (constant_prices && prices_[r * width_ + program_.p] / weights[r] > least) continue;
    sets.push_back(exchanged(active, active[r], row));
    const double goes_at = valueOf(multipliers_.data() + r * width_, crossing.data()) / weights[r];
    if (goes_at >= first) continue;
    first = goes_at;
    std::swap(sets[before], sets.back());
  }
}

double RegionBuilder::valueOf(const double* affine, const double* t) const {
  double value = affine[program_.p];
  for (int j = 0; j < program_.p; ++j) value += affine[j] * t[j];
  return value;
}

// A price vanishes on the facet: beyond, the optimum leaves that row and runs along the others until a new
// one stops it. Which one depends on the parameter, so all rows ahead are candidates.
void RegionBuilder::enter(const ActiveSet& active, int leaving, std::vector<ActiveSet>& sets) {
  const ActiveSet kept = without(active, leaving);
  Eigen::VectorXd direction = -program_.M.row(leaving);
  Eigen::MatrixXd basis(program_.n, static_cast<Eigen::Index>(kept.size()));
  for (std::size_t r = 0; r < kept.size(); ++r)
    basis.col(static_cast<Eigen::Index>(r)) = program_.M.row(kept[r]);
  if (!kept.empty()) direction -= basis * basis.colPivHouseholderQr().solve(direction);
  for (int i = 0; i < program_.m; ++i) {
    if (program_.M.row(i).dot(direction) > kExchange) sets.push_back(with(kept, i));
  }
}

Crossing RegionBuilder::neighbours(const ActiveSet& active, const RegionData& region, const Facet& facet,
                                   std::vector<ActiveSet>& sets) {
  sets.clear();
  if (facet.origin.kind == RowOrigin::Kind::kDomain) return Crossing::kEdge;
  const std::vector<RowOrigin> changes = coincident(facet);
  const bool at_border = std::any_of(changes.begin(), changes.end(), [](const RowOrigin& origin) {
    return origin.kind == RowOrigin::Kind::kDomain;
  });
  if (at_border) return Crossing::kEdge;
  if (facet.origin.kind == RowOrigin::Kind::kPrice && program_.semidefinite) {
    sets.push_back(without(active, facet.origin.index));
    return Crossing::kDegenerate;
  }
  if (facet.origin.kind == RowOrigin::Kind::kPrice) {
    enter(active, facet.origin.index, sets);
    return sets.empty() ? Crossing::kEdge : Crossing::kDegenerate;
  }
  if (changes.size() > 1) {
    combine(active, changes, crossingPoint(region, facet), sets);
    return Crossing::kDegenerate;
  }
  Crossing crossing = Crossing::kSingle;
  std::vector<double> weights;
  if (facet.origin.kind == RowOrigin::Kind::kMultiplier) {
    sets.push_back(without(active, facet.origin.index));
  } else if (!depends(active, facet.origin.index, weights)) {
    sets.push_back(with(active, facet.origin.index));
  } else {
    exchange(active, facet.origin.index, crossingPoint(region, facet), sets);
    if (sets.empty()) return Crossing::kEdge;
    crossing = Crossing::kDegenerate;
  }
  // Rows that are tight all over the region without a multiplier may get one beyond the facet.
  return idle_.empty() ? crossing : Crossing::kDegenerate;
}

// Several rows change at once in the facet: every combination of the changes is a candidate, and every
// exchange.
void RegionBuilder::combine(const ActiveSet& active, const std::vector<RowOrigin>& changes,
                            const std::vector<double>& crossing, std::vector<ActiveSet>& sets) const {
  const std::size_t count = std::min(changes.size(), kCoincidentLimit);
  for (std::size_t subset = 1; subset < (std::size_t{1} << count); ++subset) {
    ActiveSet candidate = active;
    for (std::size_t c = 0; c < count; ++c) {
      if ((subset >> c & 1u) == 0) continue;
      candidate = changes[c].kind == RowOrigin::Kind::kSlack ? with(candidate, changes[c].index)
                                                             : without(candidate, changes[c].index);
    }
    sets.push_back(std::move(candidate));
  }
  for (std::size_t c = 0; c < count; ++c) {
    if (changes[c].kind == RowOrigin::Kind::kSlack) exchange(active, changes[c].index, crossing, sets);
  }
}

}  // namespace polyfly
