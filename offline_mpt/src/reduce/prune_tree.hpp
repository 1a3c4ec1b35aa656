#pragma once

#include <cstdint>
#include <vector>

#include "offline_mpt/search_tree.hpp"
#include "reduce/cell_geometry.hpp"

namespace polyfly {

/// Laws of a reduced map's regions.
struct PruneRegions {
  std::vector<std::uint32_t> laws;
  std::size_t first_fallback = 0;  ///< laws.size() where there is none
};

/// A tree of overlapping regions with the same answers and no greater cost. A leaf loses a candidate whose
/// part there lies, within `slack`, in other candidates of its law, or in ordinary ones if it is a fallback
/// region. A node whose children are leaves, one with all candidates of the other, becomes one leaf where that makes no
/// look-up longer. Equal leaves are written once. All rows of fallback regions are tested: what they claim does not reach
/// beyond them. Where `tree` names no tests, the result names none either. `side_tolerance` is that of the tree.
SearchTree pruneTree(CellGeometry& geometry, const TreeRegions& regions, const PruneRegions& laws,
                     double slack, double side_tolerance, const SearchTree& tree);

}  // namespace polyfly
