#include "leaf_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <utility>

namespace polyfly {
namespace {

/// A row is dropped if the others bound its violation by so many tolerances.
constexpr double kDropped = 1.0;
/// A dropped row comes back if those that stay bound its violation by more tolerances than this.
constexpr double kBroughtBack = 3.0;
/// Several nodes may share a child. A leaf with more paths than this keeps its rows.
constexpr std::size_t kMostPaths = 32;
/// Rows that share the last bit of MapContent::tests are tested together.
constexpr std::uint32_t kLastBit = 31;

}  // namespace

LeafRows::LeafRows(const checker::Map& map, const checker::LookupTables& code)
    : map_(map), code_(code), paths_(code.leaves.size()) {
  const std::size_t nodes = code.node_plane.size();
  // A child comes after its parents, so its paths are known in time.
  std::vector<std::vector<Path>> ways(nodes);
  if (nodes != 0) ways[0].emplace_back();
  for (std::size_t i = 0; i < nodes; ++i) {
    for (std::uint32_t side = 0; side < 2; ++side) {
      const std::uint32_t child = code.children[i][side];
      std::vector<Path>& known = child < nodes ? ways[child] : paths_[child - nodes];
      for (Path way : ways[i]) {
        way.push_back(2 * code.node_plane[i] + side);
        // One more than the limit says that there are too many.
        if (known.size() <= kMostPaths) known.push_back(std::move(way));
      }
    }
  }
  if (nodes == 0) paths_[code.root_leaf].emplace_back();
}

checker::HalfSpace LeafRows::halfSpace(std::uint32_t row, double limit) const {
  const double* const plane = code_.planes.data() + std::size_t{row / 2} * (code_.p + 1);
  const double sign = row % 2 == 0 ? 1.0 : -1.0;
  return {plane, sign, sign * plane[code_.p] + limit + code_.plane_error[row / 2]};
}

std::vector<std::uint32_t> LeafRows::rowsOf(std::uint32_t region) const {
  const checker::Map::Region& wanted = map_.regions[region];
  std::vector<std::uint32_t> rows;
  for (std::uint32_t i = 0; i < wanted.row_count; ++i) {
    const std::int32_t row = map_.rows[wanted.first_row + i];
    rows.push_back(2 * static_cast<std::uint32_t>(std::abs(row) - 1) + (row < 0 ? 1 : 0));
  }
  return rows;
}

/// How far a parameter in the leaf may violate row `i` while it holds the others of `tests`; infinite where none holds
/// these.
double LeafRows::violation(std::uint32_t leaf, const std::vector<std::uint32_t>& rows, std::uint32_t i,
                           std::uint32_t tests) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (paths_[leaf].size() > kMostPaths) return kInfinity;
  const checker::HalfSpace beyond = halfSpace(rows[i], 0.0);
  std::vector<double> function(code_.p);
  for (std::size_t k = 0; k < code_.p; ++k) function[k] = beyond.sign * beyond.normal[k];
  double greatest = -kInfinity;
  for (const Path& path : paths_[leaf]) {
    checker::Cell cell(code_.box);
    for (const std::uint32_t row : path) cell.add(halfSpace(row, code_.tolerance));
    for (std::uint32_t other = 0; other < rows.size(); ++other) {
      if (other != i && isTested(tests, other)) cell.add(halfSpace(rows[other], code_.tolerance));
    }
    greatest = std::max(greatest, cell.upperBound(function, -beyond.sign * beyond.normal[code_.p]));
  }
  return std::isfinite(greatest) ? greatest : kInfinity;
}

std::uint32_t LeafRows::testsOf(std::uint32_t leaf, std::uint32_t region, std::uint32_t tests) const {
  const std::vector<std::uint32_t> rows = rowsOf(region);
  const auto count = static_cast<std::uint32_t>(std::min<std::size_t>(rows.size(), kLastBit));
  for (std::uint32_t i = 0; i < count; ++i) {
    if (isTested(tests, i) && violation(leaf, rows, i, tests) <= kDropped * code_.tolerance)
      tests &= ~(1u << i);
  }
  // A row that was dropped, here or in the map, may have relied on one that was dropped later.
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!isTested(tests, i) && violation(leaf, rows, i, tests) > kBroughtBack * code_.tolerance)
      tests |= 1u << i;
  }
  return tests;
}

}  // namespace polyfly
