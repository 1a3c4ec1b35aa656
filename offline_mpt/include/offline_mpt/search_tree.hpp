#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
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
  std::vector<std::uint32_t> laws;              ///< per region; empty: all differ
};

struct SearchTree {
  std::uint32_t root = MapContent::kLeaf;
  std::uint32_t depth = 0;
  std::vector<MapContent::Node> nodes;  ///< children follow their parents
  std::vector<MapContent::Leaf> leaves;
  std::vector<std::uint32_t> candidates;
};

struct TreeOptions {
  /// Regions that a leaf may hold, tested in turn. 0: 5, or 6 above 1500 regions.
  int leaf_regions = 0;
  /// A leaf may hold regions of one and the same law with so many half-spaces together; 0: 40, or 80 above
  /// 1500 regions.
  int law_rows = 0;
  /// Budget of interior nodes for small leaves: at most 2 regions, or 20 half-spaces of one law. -1: 3 per
  /// region, or 0 where leaves are chosen.
  double fine_nodes = -1.0;
  /// Budget of interior nodes, divided by regions on the way down. 0: 64 per region up to 131072, 2 per region
  /// beyond.
  std::uint64_t node_limit = 0;
  /// A part of a region that reaches no further across a plane is left to the other side [scaled].
  double side_tolerance = 1e-9;
  /// Candidate planes that are examined in a node.
  int planes_scored = 300;
  /// Best-estimated candidate planes that are split exactly. 0: 6, or 3 above 1500 regions.
  int planes_tried = 0;
  /// Number of threads. The tree does not depend on it.
  int threads = 1;
  /// Set from outside to end early: what is not split by then stays one leaf, so that the tree is of no use
  /// but for its shape.
  const std::atomic<bool>* stop = nullptr;
  /// Called now and then from the calling thread.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
};

/// Binary search tree over the regions' own planes (Tondel, Johansen and Bemporad, 2003), smallest worst case
/// first: each node takes the plane that leaves the fewest regions on its fuller side. A region stays on a
/// side if its part there, within the cell of the node, reaches further than side_tolerance, by linear
/// programming. A leaf holds few regions, or regions of one law, or those that no plane keeps apart, or what
/// the limit on nodes leaves together; a look-up tests them in turn.
SearchTree buildTree(const TreeRegions& regions, const TreeOptions& options = {});

}  // namespace polyfly
