#pragma once

#include <cstdint>
#include <vector>

#include "reduce/cell_geometry.hpp"

namespace polyfly {

/// Regions of one law that are to be described by fewer.
struct MergeTask {
  /// Regions to merge, all with interior points.
  std::vector<ConvexCell> pieces;
  // All regions of the map: a union holds the centre of none with another law.
  const std::vector<double>* centres = nullptr;      ///< p numbers each
  const std::vector<std::uint32_t>* laws = nullptr;  ///< one each
  /// Law of the pieces.
  std::uint32_t law = 0;
  /// Rows of the box.
  RowList box;
  /// A point may be this far outside a half-space and still count as inside.
  double slack = 0.0;  ///< [scaled]
};

/// Joins pairs whose envelope, the half-spaces of both that hold on both, lies in the union of all (Bemporad,
/// Fukuda and Torrisi, 2001, with help from regions beside the pair), until none is left; then leaves out
/// those that the others cover. The results have the union of the task's pieces, and may overlap.
std::vector<ConvexCell> mergeGreedily(CellGeometry& geometry, const MergeTask& task);

}  // namespace polyfly
