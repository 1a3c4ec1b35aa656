#pragma once

#include <cstdint>
#include <vector>

#include "offline_mpt/reduce.hpp"
#include "reduce/cell_geometry.hpp"
#include "region_maps/map_content.hpp"

namespace polyfly {

/// A region of a reduced map.
struct ReducedRegion {
  /// The polytope, described, and bounded by its own rows.
  ConvexCell piece;
  /// Index of the law in the original.
  std::uint32_t law = 0;
  /// The region of the original that is kept unchanged. -1: the region is a union.
  int source = -1;
};

struct ReducedRegions {
  std::vector<ReducedRegion> regions;
  RowList box;         ///< rows of the sides of the box
  double slack = 0.0;  ///< how far outside a half-space still counts as inside [scaled]
};

/// The map of these regions, with a search tree. `planes` are the original's, then those that were added. Of `options`
/// count those of the tree.
MapContent encodeReduced(const RegionMap& original, const ScaledPlanes& planes, ReducedRegions reduced,
                         const ReduceOptions& options);

}  // namespace polyfly
