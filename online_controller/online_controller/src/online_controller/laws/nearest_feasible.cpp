#include "online_controller/laws/nearest_feasible.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

// A half-space beyond the box by no more than this is the box's own [scaled].
constexpr double kSameFace = 1e-9;
// How far beyond a plane a region has a point, if the plane is no facet [scaled].
constexpr double kBeyond = 1e-6;

// The half-spaces of the set in scaled parameters: rows of a (p numbers) and c.
struct HalfSpaces {
  std::vector<double> a;
  std::vector<double> c;
};

// Whether a row bounds one parameter alone, at the end of its range: the box has it already.
bool isFaceOfBox(const double* row, double c, int parameters) {
  const double* const greatest =
      std::max_element(row, row + parameters, [](double x, double y) { return std::abs(x) < std::abs(y); });
  for (const double* entry = row; entry != row + parameters; ++entry)
    if (entry != greatest && *entry != 0.0) return false;
  return std::abs(c - std::abs(*greatest)) <= kSameFace;
}

// For each plane of the map, on which sides of it there are regions that end there.
std::vector<std::uint8_t> sidesOfPlanes(const RegionMap& map) {
  std::vector<std::uint8_t> sides(map.planeCount(), 0);
  for (std::size_t i = 0; i < map.regionCount(); ++i) {
    const RegionView region = map.region(i);
    for (std::uint32_t row = 0; row < region.row_count; ++row) {
      const std::int32_t plane = region.rows[row];
      sides[static_cast<std::size_t>(std::abs(plane)) - 1] |= plane > 0 ? 1U : 2U;
    }
  }
  return sides;
}

HalfSpaces outerHalfSpaces(const RegionMap& map, const std::vector<double>& middle,
                           const std::vector<double>& half) {
  const std::vector<std::uint8_t> sides = sidesOfPlanes(map);
  const auto parameters = static_cast<int>(middle.size());
  HalfSpaces result;
  std::vector<double> row(middle.size());
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (sides[i] != 1 && sides[i] != 2) continue;
    const double sign = sides[i] == 1 ? 1.0 : -1.0;
    const double* const plane = map.plane(i);
    double c = sign * plane[parameters];
    for (std::size_t j = 0; j < row.size(); ++j) {
      row[j] = sign * plane[j] * half[j];
      c -= sign * plane[j] * middle[j];
    }
    if (isFaceOfBox(row.data(), c, parameters)) continue;
    result.a.insert(result.a.end(), row.begin(), row.end());
    // A point on a facet is found by its rounding, so the point is moved inside by what a look-up tolerates.
    result.c.push_back(c - map.tolerance());
  }
  return result;
}

// Whether a region has a point beyond the half-space a . s <= c.
class RegionBeyond {
 public:
  RegionBeyond(const RegionMap& map, std::size_t region, const std::vector<double>& middle,
               const std::vector<double>& half)
      : parameters_(half.size()), rows_(map.region(region).row_count + 1) {
    const RegionView view = map.region(region);
    solver_ = BoundedQp(static_cast<int>(parameters_), static_cast<int>(rows_));
    A_.resize(parameters_ * rows_);
    upper_.resize(rows_);
    for (std::size_t row = 0; row + 1 < rows_; ++row) {
      const double sign = view.rows[row] > 0 ? 1.0 : -1.0;
      const double* const plane = map.plane(static_cast<std::size_t>(std::abs(view.rows[row])) - 1);
      upper_[row] = sign * plane[parameters_];
      for (std::size_t j = 0; j < parameters_; ++j) {
        A_[j * rows_ + row] = sign * plane[j] * half[j];
        upper_[row] -= sign * plane[j] * middle[j];
      }
    }
    std::vector<double> H(parameters_ * parameters_, 0.0);
    for (std::size_t j = 0; j < parameters_; ++j) H[j * (parameters_ + 1)] = 1.0;
    solver_.setConstantHessian(H.data());
  }

  bool operator()(const double* a, double c) {
    for (std::size_t j = 0; j < parameters_; ++j) A_[j * rows_ + rows_ - 1] = -a[j];
    upper_[rows_ - 1] = -c - kBeyond;
    solver_.setRows(A_.data());
    const std::vector<double> gradient(parameters_, 0.0), ones(parameters_, 1.0),
        minus_ones(parameters_, -1.0);
    const std::vector<double> open(rows_, -std::numeric_limits<double>::infinity());
    return solver_.solve({gradient.data(), minus_ones.data(), ones.data(), open.data(), upper_.data()}) ==
           QpStatus::kOptimal;
  }

 private:
  std::size_t parameters_;
  std::size_t rows_;
  BoundedQp solver_{1};
  std::vector<double> A_, upper_;
};

// Joined regions of a reduced map may overlap, so that a plane within the set bounds regions from one side only. It is
// no facet, because others lie beyond it.
HalfSpaces withoutInnerPlanes(const RegionMap& map, const HalfSpaces& found,
                              const std::vector<double>& middle, const std::vector<double>& half) {
  std::vector<bool> inner(found.c.size(), false);
  for (std::size_t i = 0; i < map.regionCount(); ++i) {
    RegionBeyond beyond(map, i, middle, half);
    for (std::size_t row = 0; row < inner.size(); ++row)
      inner[row] = inner[row] || beyond(found.a.data() + row * half.size(), found.c[row]);
  }
  HalfSpaces result;
  for (std::size_t row = 0; row < inner.size(); ++row) {
    if (inner[row]) continue;
    const double* const a = found.a.data() + row * half.size();
    result.a.insert(result.a.end(), a, a + half.size());
    result.c.push_back(found.c[row]);
  }
  return result;
}

}  // namespace

NearestFeasible::NearestFeasible(const RegionMap& map, const std::vector<bool>& movable) : movable_(movable) {
  for (const Signal& signal : map.parameters()) {
    middle_.push_back(0.5 * (signal.lower + signal.upper));
    half_.push_back(0.5 * (signal.upper - signal.lower));
  }
  HalfSpaces set = outerHalfSpaces(map, middle_, half_);
  if (map.reducedFrom() != 0) set = withoutInnerPlanes(map, set, middle_, half_);
  const auto n = static_cast<int>(half_.size());
  const auto m = static_cast<int>(set.c.size());
  solver_ = BoundedQp(n, m);
  search_limit_ = 10 * (n + m) + 30;
  solver_.setIterationLimit(search_limit_);
  std::vector<double> H(half_.size() * half_.size(), 0.0), columns(set.a.size());
  for (std::size_t i = 0; i < half_.size(); ++i) H[i * (half_.size() + 1)] = 1.0;
  for (std::size_t row = 0; row < set.c.size(); ++row)
    for (std::size_t j = 0; j < half_.size(); ++j)
      columns[j * set.c.size() + row] = set.a[row * half_.size() + j];
  solver_.setConstantHessian(H.data());
  solver_.setRows(columns.data());
  gradient_.resize(half_.size());
  lower_.resize(half_.size());
  upper_.resize(half_.size());
  row_lower_.assign(set.c.size(), -std::numeric_limits<double>::infinity());
  row_upper_ = set.c;
}

bool NearestFeasible::find(const double* theta, double* nearest) noexcept {
  iterations_ = 0;
  for (std::size_t i = 0; i < half_.size(); ++i) {
    gradient_[i] = (middle_[i] - theta[i]) / half_[i];
    if (!std::isfinite(gradient_[i])) return false;
  }
  if (!search(false) && !search(true)) return false;
  for (std::size_t i = 0; i < half_.size(); ++i) {
    const bool kept = lower_[i] == upper_[i];
    nearest[i] = kept ? theta[i] : middle_[i] + half_[i] * solver_.x()[i];
  }
  return true;
}

bool NearestFeasible::search(bool all_movable) noexcept {
  for (std::size_t i = 0; i < half_.size(); ++i) {
    const bool moves = all_movable || movable_[i];
    lower_[i] = moves ? -1.0 : -gradient_[i];
    upper_[i] = moves ? 1.0 : -gradient_[i];
  }
  const QpStatus status =
      solver_.solve({gradient_.data(), lower_.data(), upper_.data(), row_lower_.data(), row_upper_.data()});
  iterations_ += solver_.iterations();
  return status == QpStatus::kOptimal;
}

}  // namespace polyfly
