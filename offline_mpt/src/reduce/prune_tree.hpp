#pragma once

#include <cstdint>
#include <vector>

#include "offline_mpt/search_tree.hpp"
#include "reduce/cell_geometry.hpp"

namespace polyfly {

/// A tree of overlapping regions, whose `laws` are given, with the same answers and no greater cost. A leaf loses a
/// candidate whose part there lies, within `slack`, in other candidates of its law. A node whose children are leaves, one
/// with all candidates of the other, becomes one leaf where that makes no look-up longer. Equal leaves are written once.
/// Where `tree` names no tests, the result names none either. `side_tolerance` is that of the tree.
SearchTree pruneTree(CellGeometry& geometry, const TreeRegions& regions,
                     const std::vector<std::uint32_t>& laws, double slack, double side_tolerance,
                     const SearchTree& tree);

}  // namespace polyfly
