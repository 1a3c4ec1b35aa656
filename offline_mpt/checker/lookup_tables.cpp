#include "lookup_tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace checker {
namespace {

// The sums below are in doubles; this covers their rounding.
constexpr double kOwnRounding = 1.0 + 1e-9;
// Of differences, of parameters that are rounded into the box of floats.
constexpr double kRoundedBox = 1.0 + 1e-6;

/// Bound of the error of sum a_i theta_i + constant, theta in the box.
double errorOf(const double* entries, const LookupTables& tables, const Arithmetic& arithmetic) {
  const std::size_t p = tables.p;
  double size = std::abs(entries[p]);
  double from_parameters = 0.0;
  double underflow = static_cast<double>(2 * p + 2) * arithmetic.smallest;
  for (std::size_t i = 0; i < p; ++i) {
    const double greatest = tables.box.greatest(i);
    const double rounding = tables.parameter_error[i];
    from_parameters += std::abs(entries[i]) * rounding;
    size += std::abs(entries[i]) * (greatest + rounding);
    // An entry may be flushed to zero too.
    underflow += greatest * arithmetic.smallest;
  }
  // Each term passes one product and at most p + 1 additions.
  const auto roundings = static_cast<double>(p + 2);
  const double gamma = roundings * arithmetic.unit / (1.0 - roundings * arithmetic.unit);
  require(2.0 * size < arithmetic.greatest, "a sum of the look-up may overflow");
  return (from_parameters + gamma * size + underflow) * kOwnRounding;
}

std::uint32_t childOf(const Map& map, std::uint32_t child) {
  const bool is_leaf = (child & Map::kLeaf) != 0;
  return is_leaf ? static_cast<std::uint32_t>(map.nodes.size()) + (child & ~Map::kLeaf) : child;
}

bool isTested(const Map& map, std::size_t candidate, std::uint32_t row) {
  if (map.tests.empty()) return true;
  return (map.tests[candidate] >> (row < 31 ? row : 31) & 1u) != 0;
}

LookupTables::Candidate candidateOf(const Map& map, std::size_t number) {
  LookupTables::Candidate candidate;
  candidate.region = map.candidates[number];
  const Map::Region& region = map.regions[candidate.region];
  candidate.law = region.law;
  for (std::uint32_t i = 0; i < region.row_count; ++i) {
    const std::int32_t row = map.rows[region.first_row + i];
    if (isTested(map, number, i))
      candidate.rows.push_back(2 * static_cast<std::uint32_t>(std::abs(row) - 1) + (row < 0 ? 1 : 0));
  }
  return candidate;
}

/// The greatest difference of the values of two planes in the box.
double differenceOf(const double* a, const double* b, const Box& box) {
  double difference = std::abs(a[box.size()] - b[box.size()]);
  for (std::size_t i = 0; i < box.size(); ++i) difference += std::abs(a[i] - b[i]) * box.greatest(i);
  return difference * kRoundedBox;
}

/// Finds the nearest of the map's planes. Two planes differ in the box at least by as much as at one point of it. So those
/// whose values at a point are further apart than the nearest so far need not be looked at.
class NearestPlane {
 public:
  NearestPlane(const std::vector<double>& planes, const Box& box) : planes_(planes), box_(box) {
    for (std::size_t k = 0; k < planes.size() / (box.size() + 1); ++k) sorted_.emplace_back(keyOf(at(k)), k);
    std::sort(sorted_.begin(), sorted_.end());
  }

  /// Of several with the least difference the first.
  std::pair<double, std::size_t> find(const double* plane) const {
    std::pair<double, std::size_t> best(std::numeric_limits<double>::infinity(), 0);
    const double key = keyOf(plane);
    const auto middle = std::lower_bound(sorted_.begin(), sorted_.end(), std::make_pair(key, std::size_t{0}));
    for (auto next = middle; next != sorted_.end() && next->first - key <= best.first; ++next)
      best = std::min(best, differenceTo(plane, next->second));
    for (auto next = middle; next != sorted_.begin() && key - (next - 1)->first <= best.first; --next)
      best = std::min(best, differenceTo(plane, (next - 1)->second));
    return best;
  }

 private:
  const double* at(std::size_t k) const { return planes_.data() + k * (box_.size() + 1); }
  std::pair<double, std::size_t> differenceTo(const double* plane, std::size_t k) const {
    return {differenceOf(plane, at(k), box_), k};
  }
  /// The value at a point that has no symmetry.
  double keyOf(const double* plane) const {
    double value = plane[box_.size()];
    for (std::size_t i = 0; i < box_.size(); ++i)
      value += plane[i] * box_.greatest(i) / (1.5 + static_cast<double>(i));
    return value;
  }

  const std::vector<double>& planes_;
  const Box& box_;
  std::vector<std::pair<double, std::size_t>> sorted_;
};

}  // namespace

void boundRounding(LookupTables& tables, const Arithmetic& arithmetic) {
  const std::size_t stride = tables.p + 1;
  tables.plane_error.clear();
  tables.law_error.clear();
  tables.parameter_error.assign(tables.p, 0.0);
  for (std::size_t i = 0; i < tables.p && arithmetic.rounds_parameters; ++i)
    tables.parameter_error[i] = tables.box.greatest(i) * arithmetic.unit + arithmetic.smallest;
  for (std::size_t at = 0; at < tables.planes.size(); at += stride)
    tables.plane_error.push_back(errorOf(tables.planes.data() + at, tables, arithmetic));
  for (std::size_t at = 0; at < tables.laws.size(); at += stride)
    tables.law_error.push_back(errorOf(tables.laws.data() + at, tables, arithmetic));
}

LookupTables lookupOf(const Map& map) {
  LookupTables tables;
  tables.p = map.p;
  tables.q = map.q;
  for (std::size_t i = 0; i < tables.p; ++i) {
    const double lower = map.bounds[2 * i], upper = map.bounds[2 * i + 1];
    const double slack = map.tolerance * (0.5 * upper - 0.5 * lower);
    tables.box.lower.push_back(lower - slack);
    tables.box.upper.push_back(upper + slack);
  }
  tables.planes = map.planes;
  tables.laws = map.laws;
  tables.tolerance = map.tolerance;
  for (const Map::Node& node : map.nodes) {
    tables.node_plane.push_back(node.plane);
    tables.children.push_back({childOf(map, node.below), childOf(map, node.above)});
  }
  tables.root_leaf = map.root & ~Map::kLeaf;
  for (const Map::Leaf& leaf : map.leaves) {
    tables.leaves.emplace_back();
    for (std::size_t i = leaf.first; i < std::size_t{leaf.first} + leaf.count; ++i)
      tables.leaves.back().push_back(candidateOf(map, i));
  }
  boundRounding(tables, kDoubles);
  return tables;
}

LookupTables withPlanesOf(const LookupTables& map, LookupTables code, double most) {
  const std::size_t stride = map.p + 1;
  std::vector<std::uint32_t> number;
  std::vector<double> error(map.plane_error.size(), -1.0);
  const NearestPlane planes(map.planes, code.box);
  for (std::size_t i = 0; i < code.planes.size() / stride; ++i) {
    const auto [least, k] = planes.find(code.planes.data() + i * stride);
    require(least <= most, "a plane of the code is none of the map's");
    number.push_back(static_cast<std::uint32_t>(k));
    error[k] = std::max(error[k], code.plane_error[i] + least);
  }
  for (std::uint32_t& plane : code.node_plane) plane = number[plane];
  for (std::vector<LookupTables::Candidate>& leaf : code.leaves) {
    for (LookupTables::Candidate& candidate : leaf) {
      for (std::uint32_t& row : candidate.rows) row = 2 * number[row / 2] + row % 2;
    }
  }
  const double greatest = error.empty() ? 0.0 : *std::max_element(error.begin(), error.end());
  std::replace(error.begin(), error.end(), -1.0, greatest);
  code.planes = map.planes;
  code.plane_error = std::move(error);
  return code;
}

}  // namespace checker
