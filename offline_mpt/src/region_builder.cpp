#include "region_builder.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace polyfly {
namespace {

constexpr double kSafePivot = 1e-6;  // squared distance from others below which products of unit rows mislead
constexpr double kIndependent = 1e-7;  // distance of a unit row from the span of the others
constexpr double kConstant = 1e-11;    // relative slope below which a row does not depend on the parameters
constexpr double kCoincident = 1e-9;   // difference below which two unit half-spaces are the same plane
constexpr double kUnpaid = 1e-9;    // part of the cost that prices may leave, relative to its largest entry
constexpr double kExchange = 1e-9;  // weight above which a row can leave in an exchange
constexpr double kClear =
    1e-4;  // slack, relative to the multipliers' size, that leaves no doubt whatever the slope
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

}  // namespace

RegionBuilder::RegionBuilder(const LeastDistance& program, double facet_tolerance, double radius_tolerance)
    : program_(program),
      facet_tolerance_(facet_tolerance),
      radius_tolerance_(radius_tolerance),
      width_(program.p + 1),
      gram_(static_cast<std::size_t>(program.m) * program.m),
      D_(static_cast<std::size_t>(program.m) * width_),
      is_active_(program.m, 0),
      scratch_(program.p + 1),
      solver_(program.p) {
  for (int i = 0; i < program.m; ++i) {
    for (int j = 0; j < program.m; ++j)
      gram_[static_cast<std::size_t>(i) * program.m + j] = program.gram(i, j);
    for (int j = 0; j < width_; ++j) D_[static_cast<std::size_t>(i) * width_ + j] = program.D(i, j);
  }
}

bool RegionBuilder::factorise(const ActiveSet& active) {
  const int k = static_cast<int>(active.size());
  if (k > program_.n) return false;
  factor_.resize(static_cast<std::size_t>(k) * k);
  for (int r = 0; r < k; ++r) {
    const double* source = gram_.data() + static_cast<std::size_t>(active[r]) * program_.m;
    double* row = factor_.data() + static_cast<std::size_t>(r) * k;
    for (int c = 0; c <= r; ++c) {
      const double* other = factor_.data() + static_cast<std::size_t>(c) * k;
      double value = source[active[c]];
      for (int i = 0; i < c; ++i) value -= row[i] * other[i];
      if (c < r) {
        row[c] = value / other[c];
      } else if (value > kSafePivot) {
        row[c] = std::sqrt(value);
      } else {
        return factoriseAccurately(active);
      }
    }
  }
  return true;
}

// The same factor from the rows themselves, orthogonalised twice: distances come out with full accuracy,
// where products of rows only keep their squares. Few sets need it.
bool RegionBuilder::factoriseAccurately(const ActiveSet& active) {
  const int k = static_cast<int>(active.size());
  Eigen::MatrixXd basis(program_.n, k);
  for (int r = 0; r < k; ++r) {
    Eigen::VectorXd row = program_.M.row(active[r]);
    double* out = factor_.data() + static_cast<std::size_t>(r) * k;
    std::fill(out, out + r, 0.0);
    for (int pass = 0; pass < 2; ++pass) {
      for (int c = 0; c < r; ++c) {
        const double weight = basis.col(c).dot(row);
        out[c] += weight;
        row -= weight * basis.col(c);
      }
    }
    out[r] = row.norm();
    if (out[r] <= kIndependent) return false;
    basis.col(r) = row / out[r];
  }
  return true;
}

// Solves factor factor' X = X in place for width_ right-hand sides lying side by side.
void RegionBuilder::solveFactor(double* x) const {
  const int k = static_cast<int>(multipliers_.size()) / width_;
  for (int r = 0; r < k; ++r) {
    double* row = x + r * width_;
    for (int c = 0; c < r; ++c) {
      const double weight = factor_[static_cast<std::size_t>(r) * k + c];
      for (int j = 0; j < width_; ++j) row[j] -= weight * x[c * width_ + j];
    }
    const double inverse = 1.0 / factor_[static_cast<std::size_t>(r) * k + r];
    for (int j = 0; j < width_; ++j) row[j] *= inverse;
  }
  for (int r = k - 1; r >= 0; --r) {
    double* row = x + r * width_;
    for (int c = r + 1; c < k; ++c) {
      const double weight = factor_[static_cast<std::size_t>(c) * k + r];
      for (int j = 0; j < width_; ++j) row[j] -= weight * x[c * width_ + j];
    }
    const double inverse = 1.0 / factor_[static_cast<std::size_t>(r) * k + r];
    for (int j = 0; j < width_; ++j) row[j] *= inverse;
  }
}

// Adds affine (t, 1) >= 0 as a unit half-space. False: the set describes no region.
bool RegionBuilder::addRow(const double* affine, RowOrigin origin, double scale, BuildStatus& status) {
  double squared = 0.0;
  for (int j = 0; j < program_.p; ++j) squared += affine[j] * affine[j];
  const double length = std::sqrt(squared);
  if (length <= kConstant * scale) {
    if (affine[program_.p] < -kConstant * scale) {
      status = BuildStatus::kThin;
      return false;
    }
    if (origin.kind == RowOrigin::Kind::kMultiplier && affine[program_.p] <= kConstant * scale) {
      status = BuildStatus::kWeak;
      return false;
    }
    return true;
  }
  const double inverse = 1.0 / length;
  for (int j = 0; j < program_.p; ++j) rows_.push_back(-affine[j] * inverse);
  rows_.push_back(affine[program_.p] * inverse);
  origins_.push_back(origin);
  return true;
}

// Prices of the active rows, -gram^-1 M cost. False unless they pay for the whole cost with no price negative
// everywhere.
bool RegionBuilder::priceOut(const ActiveSet& active) {
  const auto k = static_cast<Eigen::Index>(active.size());
  prices_.resize(multipliers_.size());
  for (Eigen::Index r = 0; r < k; ++r) {
    for (int j = 0; j < width_; ++j)
      prices_[r * width_ + j] = -program_.M.row(active[r]).dot(program_.cost.col(j));
  }
  solveFactor(prices_.data());
  const double scale = program_.cost.cwiseAbs().maxCoeff();
  Eigen::MatrixXd rest = program_.cost;
  for (Eigen::Index r = 0; r < k; ++r) {
    for (int j = 0; j < width_; ++j)
      rest.col(j) += prices_[r * width_ + j] * program_.M.row(active[r]).transpose();
  }
  return rest.cwiseAbs().maxCoeff() <= kUnpaid * scale;
}

BuildStatus RegionBuilder::addMultiplierRows(const ActiveSet& active, double scale) {
  BuildStatus status = BuildStatus::kRegion;
  const double price_scale = program_.linear ? program_.cost.cwiseAbs().maxCoeff() : 0.0;
  for (std::size_t r = 0; r < active.size(); ++r) {
    if (program_.linear) {
      const double* price = prices_.data() + r * width_;
      const double largest = std::abs(*std::max_element(
          price, price + width_, [](double a, double b) { return std::abs(a) < std::abs(b); }));
      if (largest > kUnpaid * price_scale) {  // the multiplier's sign is the price's
        for (int j = 0; j < width_; ++j)
          scratch_[j] = std::abs(price[j]) > kUnpaid * price_scale ? price[j] : 0.0;
        if (!addRow(scratch_.data(), {RowOrigin::Kind::kPrice, active[r]}, price_scale, status))
          return status;
        continue;
      }
    }
    if (!addRow(multipliers_.data() + r * width_, {RowOrigin::Kind::kMultiplier, active[r]}, scale, status)) {
      return status;
    }
  }
  return status;
}

// Slack of an inactive row as a function of (t, 1), into scratch_.
void RegionBuilder::slackRow(const ActiveSet& active, int row) {
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
  idle_.clear();
  for (const int row : active) is_active_[row] = 1;
  for (int i = 0; i < program_.m && status == BuildStatus::kRegion; ++i) {
    if (is_active_[i]) continue;
    slackRow(active, i);
    const std::size_t before = origins_.size();
    addRow(scratch_.data(), {RowOrigin::Kind::kSlack, i}, scale, status);
    if (origins_.size() == before && scratch_[program_.p] <= kConstant * scale) {
      idle_.push_back(static_cast<std::uint16_t>(i));
    }
  }
  for (const int row : active) is_active_[row] = 0;
  return status;
}

// Multipliers of the active rows as functions of (t, 1), and the size of their constants and slopes. False
// where the rows are dependent.
bool RegionBuilder::findMultipliers(const ActiveSet& active, double& scale) {
  multipliers_.resize(active.size() * width_);
  if (!factorise(active)) return false;
  scale = 1.0;
  for (std::size_t r = 0; r < active.size(); ++r) {
    for (int j = 0; j < width_; ++j) {
      const double value = -D_[static_cast<std::size_t>(active[r]) * width_ + j];
      multipliers_[r * width_ + j] = value;
      scale = std::max(scale, std::abs(value));
    }
  }
  solveFactor(multipliers_.data());
  return true;
}

BuildStatus RegionBuilder::assembleRows(const ActiveSet& active) {
  double scale = 1.0;
  if (!findMultipliers(active, scale)) return BuildStatus::kDependent;
  if (program_.linear && !priceOut(active)) return BuildStatus::kThin;

  rows_.assign(program_.domain.begin(), program_.domain.end());
  origins_.clear();
  for (int d = 0; d < program_.domainCount(); ++d) origins_.push_back({RowOrigin::Kind::kDomain, d});
  const BuildStatus status = addMultiplierRows(active, scale);
  return status == BuildStatus::kRegion ? addSlackRows(active, scale) : status;
}

BuildStatus RegionBuilder::build(const ActiveSet& active, RegionData& region) {
  const BuildStatus status = assembleRows(active);
  if (status != BuildStatus::kRegion) return status;
  const int count = static_cast<int>(origins_.size());
  region.centre.assign(program_.p, 0.0);
  if (!solver_.chebyshev(rows_.data(), count, region.centre.data(), region.radius))
    return BuildStatus::kFailed;
  if (region.radius <= radius_tolerance_) return BuildStatus::kThin;
  // A facet of a thin region shows at the region's own scale.
  const double tolerance = std::min(facet_tolerance_, 0.1 * region.radius);
  if (!solver_.minimal(rows_.data(), count, region.centre.data(), tolerance, minimal_))
    return BuildStatus::kFailed;
  region.tight = active;
  region.tight.insert(region.tight.end(), idle_.begin(), idle_.end());
  std::sort(region.tight.begin(), region.tight.end());
  region.by_slack = std::none_of(origins_.begin(), origins_.end(), [](const RowOrigin& origin) {
    return origin.kind == RowOrigin::Kind::kMultiplier || origin.kind == RowOrigin::Kind::kPrice;
  });
  region.facets.resize(minimal_.facets.size());
  for (std::size_t f = 0; f < minimal_.facets.size(); ++f) {
    const int row = minimal_.facets[f];
    Facet& facet = region.facets[f];
    facet.origin = origins_[row];
    facet.row.assign(rows_.begin() + row * width_, rows_.begin() + (row + 1) * width_);
    facet.beyond.assign(minimal_.beyond.begin() + f * program_.p,
                        minimal_.beyond.begin() + (f + 1) * program_.p);
  }
  law(active, region.law);
  return BuildStatus::kRegion;
}

void RegionBuilder::law(const ActiveSet& active, std::vector<double>& out) const {
  const int q = static_cast<int>(program_.U.rows());
  out.resize(static_cast<std::size_t>(q) * width_);
  for (int i = 0; i < q; ++i) {
    for (int j = 0; j < width_; ++j) {
      double value = program_.U(i, j);
      for (std::size_t r = 0; r < active.size(); ++r) {
        value += program_.V(i, active[r]) * multipliers_[r * width_ + j];
      }
      out[static_cast<std::size_t>(i) * width_ + j] = value;
    }
  }
}

// Rows whose plane is the facet's.
std::vector<RowOrigin> RegionBuilder::coincident(const Facet& facet) const {
  std::vector<RowOrigin> result;
  for (std::size_t i = 0; i < origins_.size(); ++i) {
    double difference = 0.0;
    for (int j = 0; j < width_; ++j)
      difference = std::max(difference, std::abs(rows_[i * width_ + j] - facet.row[j]));
    if (difference <= kCoincident) result.push_back(origins_[i]);
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
// facet. Constant prices tell which goes first: those of least price / w_j.
void RegionBuilder::exchange(const ActiveSet& active, int row, std::vector<ActiveSet>& sets) const {
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
  for (std::size_t r = 0; r < active.size(); ++r) {
    if (weights[r] <= kExchange) continue;
    if (constant_prices && prices_[r * width_ + program_.p] / weights[r] > least) continue;
    sets.push_back(with(without(active, active[r]), row));
  }
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

Crossing RegionBuilder::neighbours(const ActiveSet& active, const Facet& facet,
                                   std::vector<ActiveSet>& sets) {
  sets.clear();
  if (facet.origin.kind == RowOrigin::Kind::kDomain) return Crossing::kEdge;
  const std::vector<RowOrigin> changes = coincident(facet);
  const bool at_border = std::any_of(changes.begin(), changes.end(), [](const RowOrigin& origin) {
    return origin.kind == RowOrigin::Kind::kDomain;
  });
  if (at_border) return Crossing::kEdge;
  if (facet.origin.kind == RowOrigin::Kind::kPrice) {
    enter(active, facet.origin.index, sets);
    return sets.empty() ? Crossing::kEdge : Crossing::kDegenerate;
  }
  if (changes.size() == 1) {
    if (facet.origin.kind == RowOrigin::Kind::kMultiplier) {
      sets.push_back(without(active, facet.origin.index));
      return Crossing::kSingle;
    }
    std::vector<double> weights;
    if (!depends(active, facet.origin.index, weights)) {
      sets.push_back(with(active, facet.origin.index));
      return Crossing::kSingle;
    }
    exchange(active, facet.origin.index, sets);
    return sets.empty() ? Crossing::kEdge : Crossing::kDegenerate;
  }
  combine(active, changes, sets);
  return Crossing::kDegenerate;
}

// Several rows change at once in the facet: every combination of the changes is a candidate, and every
// exchange.
void RegionBuilder::combine(const ActiveSet& active, const std::vector<RowOrigin>& changes,
                            std::vector<ActiveSet>& sets) const {
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
    if (changes[c].kind == RowOrigin::Kind::kSlack) exchange(active, changes[c].index, sets);
  }
}

bool RegionBuilder::holds(const ActiveSet& active, const double* t, double tolerance) {
  double scale = 1.0;
  if (!findMultipliers(active, scale)) return false;
  if (program_.linear && !priceOut(active)) return false;
  rows_.clear();
  origins_.clear();
  if (addMultiplierRows(active, scale) != BuildStatus::kRegion || !satisfied(t, tolerance)) return false;
  return holdsSlacks(active, t, tolerance, scale);
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
bool RegionBuilder::holdsSlacks(const ActiveSet& active, const double* t, double tolerance, double scale) {
  const auto at = [&](const double* affine) {
    double value = affine[program_.p];
    for (int j = 0; j < program_.p; ++j) value += affine[j] * t[j];
    return value;
  };
  at_point_.resize(active.size());
  for (std::size_t r = 0; r < active.size(); ++r) at_point_[r] = at(multipliers_.data() + r * width_);
  rows_.clear();
  origins_.clear();
  for (const int row : active) is_active_[row] = 1;
  BuildStatus status = BuildStatus::kRegion;
  for (int i = 0; i < program_.m && status == BuildStatus::kRegion; ++i) {
    if (is_active_[i]) continue;
    const double* gram = gram_.data() + static_cast<std::size_t>(i) * program_.m;
    double slack = at(D_.data() + static_cast<std::size_t>(i) * width_);
    for (std::size_t r = 0; r < active.size(); ++r) slack += gram[active[r]] * at_point_[r];
    if (slack > kClear * scale) continue;
    slackRow(active, i);
    addRow(scratch_.data(), {RowOrigin::Kind::kSlack, i}, scale, status);
  }
  for (const int row : active) is_active_[row] = 0;
  return status == BuildStatus::kRegion && satisfied(t, tolerance);
}

}  // namespace polyfly
