#include "online_controller/laws/nearest_feasible.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

// A half-space beyond the box by no more than this is the box's own [scaled].
constexpr double kSameFace = 1e-9;

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

}  // namespace

NearestFeasible::NearestFeasible(const RegionMap& map, const std::vector<bool>& movable) : movable_(movable) {
  if (map.firstFallback() < map.regionCount()) {
    throw Error(map.path() +
                ": regions: a robust law needs a map without fallback regions, as reduce writes it without "
                "--separate");
  }
  for (const Signal& signal : map.parameters()) {
    middle_.push_back(0.5 * (signal.lower + signal.upper));
    half_.push_back(0.5 * (signal.upper - signal.lower));
  }
  const HalfSpaces set = outerHalfSpaces(map, middle_, half_);
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
