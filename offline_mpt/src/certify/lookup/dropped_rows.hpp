#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "certify/lookup/lookup_tree.hpp"
#include "certify/lookup/whole_planes.hpp"

namespace polyfly {

/// Tolerances of a look-up by which rows that it does not test may be violated.
constexpr int kReach = 8;

/// A row of a region that no leaf below a node tests. At the node it follows from rows on the path, with weights w, and
/// from other rows of the region, with weights v: row = sum of w row + sum of v row + rest, and rest >= constant wherever
/// look-ups answer. The other rows are tested, or dropped later. Numbers are rounded such that conclusions hold.
struct DroppedRow {
  /// The node or leaf, by its place in the tree.
  std::size_t visit = 0;
  std::uint32_t row = 0;
  double constant = 0.0;
  /// Sum of the weights of path rows.
  double least_path_weight = 0.0, most_path_weight = 0.0;
  /// Sum of the weights of the others.
  double row_weight = 0.0;
  /// Rows of the region, with their weights.
  std::vector<std::pair<std::uint32_t, double>> rows;

  /// Whether the row is >= 0 where path rows are >= depth and conditions of optimality >= 0, from which planes of the
  /// map differ by at most `error`.
  bool holdsInside(double depth, double error) const;
};

/// A row that is not tested at a leaf, and may be violated there by more than kReach tolerances, as far as is proven.
struct UnboundedRow {
  std::size_t visit = 0;
  std::uint32_t row = 0;
  double reach = 0.0;
};

/// All dropped rows of a region: ascending by visit, and for one visit in the order in which they are dropped. A row may
/// be dropped again at a leaf, where that proves more.
struct RegionDrops {
  /// Lines of the certificate.
  std::string text;
  std::vector<DroppedRow> rows;
  std::vector<UnboundedRow> unbounded;

  struct Range {
    const DroppedRow* first;
    const DroppedRow* last;
    const DroppedRow* begin() const { return first; }
    const DroppedRow* end() const { return last; }
  };
  Range at(std::size_t visit) const;
};

/// Drops rows of a region as early as can be on all ways to leaves where it is a candidate.
RegionDrops dropRows(const RegionMap& map, const WholePlanes& planes, const LookupTree& tree,
                     std::uint32_t region);

}  // namespace polyfly
