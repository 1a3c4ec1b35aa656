#pragma once

#include <cstdint>
#include <vector>

#include "region_maps/map_content.hpp"

namespace polyfly {

/// Regions in scaled parameters, as the tree builder sees them. A plane is p + 1 numbers (a, c) with |a| = 1,
/// the half-space a . t <= c; rows refer to planes as MapContent::rows does.
struct TreeRegions {
  int p = 0;
  std::vector<double> planes;
  std::vector<std::vector<std::int32_t>> rows;  ///< per region
  std::vector<double> centres;                  ///< per region p numbers, strictly inside
};

struct SearchTree {
  std::uint32_t root = MapContent::kLeaf;
  std::uint32_t depth = 0;
  std::vector<MapContent::Node> nodes;  ///< children follow their parents
  std::vector<MapContent::Leaf> leaves;
  std::vector<std::uint32_t> candidates;
};

struct TreeOptions {
  int leaf_regions = 0;  ///< a leaf may hold so many regions, tested in turn; 0: 1, or 8 above 1500 regions
  double side_tolerance =
      1e-9;  ///< a part of a region whose inscribed ball is smaller is left to the other side [scaled]
  int planes_scored = 300;  ///< candidate planes looked at in a node
  int planes_tried = 6;     ///< of these, the best by estimate, split exactly
};

/// Binary search tree over the regions' own planes (Tondel, Johansen and Bemporad, 2003), smallest worst case
/// first: each node takes the plane that leaves the fewest regions on its fuller side. A region stays on a
/// side if its part there, within the cell of the node, holds a ball larger than side_tolerance, by linear
/// programming. A leaf holds one region, or those that no plane separates.
SearchTree buildTree(const TreeRegions& regions, const TreeOptions& options = {});

}  // namespace polyfly
