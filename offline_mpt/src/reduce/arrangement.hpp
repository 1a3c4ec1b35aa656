#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "reduce/merge.hpp"

namespace polyfly {

/// A cell of a hyperplane arrangement: bit i of `signs` is set where plane i's half-space does not hold.
struct ArrangementCell {
  std::uint64_t signs = 0;
  std::vector<double> centre;
  double radius = 0.0;
  /// Whether the cell lies in the union of the pieces.
  bool inside = false;
};

/// All planes of some pieces that cut their envelope, and the cells that these make of it.
struct Arrangement {
  static constexpr std::size_t kMaxPlanes = 64;

  /// Envelope of all pieces.
  RowList hull;
  /// The planes as rows that are not negated (> 0).
  RowList planes;
  std::vector<ArrangementCell> cells;
};

/// Empty where there are more planes or cells than the limits allow. Cells thinner than `least_radius` are
/// left out: they may count as inside or not.
std::optional<Arrangement> arrange(CellGeometry& geometry, std::vector<ConvexCell>& pieces,
                                   const RowList& box, double slack, const MergeLimits& limits);

}  // namespace polyfly
