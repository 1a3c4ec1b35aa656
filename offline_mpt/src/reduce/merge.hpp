#pragma once

#include <cstddef>
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

struct MergeLimits {
  /// Greatest number of planes of an arrangement, at most 64.
  std::size_t planes = 24;
  /// Greatest number of cells of an arrangement.
  std::size_t cells = 1000;
  /// Greatest number of convex unions that are examined.
  std::size_t unions = 20'000;
  /// Greatest number of branches in the search for the fewest unions.
  std::uint64_t covers = 50'000;
};

struct Merged {
  std::vector<ConvexCell> pieces;  ///< their union is that of the task's; they may overlap
  bool optimal = false;            ///< no smaller number of convex unions bounded by the regions' own planes
};

/// Joins pairs whose envelope, the half-spaces of both that hold on both, lies in the union of all (Bemporad,
/// Fukuda and Torrisi, 2001, with help from regions beside the pair), until none is left; then leaves out
/// those that the others cover.
Merged mergeGreedily(CellGeometry& geometry, const MergeTask& task);

/// The fewest convex unions, which may overlap (after Geyer, Torrisi and Morari, 2008): cells of the
/// arrangement of all the regions' planes, all maximal convex unions of cells, and a minimum cover by these,
/// for each connected part. Where a limit is reached, what mergeGreedily finds.
Merged mergeOptimally(CellGeometry& geometry, const MergeTask& task, const MergeLimits& limits);

/// The half-spaces of some pieces that hold on all of them, with the box, without redundant ones.
class Envelopes {
 public:
  Envelopes(CellGeometry& geometry, std::vector<ConvexCell>& pieces, const RowList& box, double slack);
  ConvexCell of(const std::vector<std::size_t>& members);

 private:
  bool holdsOn(std::size_t row, std::size_t piece);

  CellGeometry& geometry_;
  std::vector<ConvexCell>& pieces_;
  const RowList& box_;
  double slack_;
  // Rows of all pieces, sorted.
  RowList rows_;
  // Whether each row holds on each piece, by piece and row.
  std::vector<std::vector<char>> known_;
};

}  // namespace polyfly
