#pragma once

#include <cstdint>
#include <vector>

#include "offline_mpt/search_tree.hpp"
#include "reduce/cell_geometry.hpp"

namespace polyfly {

/// Regions of a reduced map.
struct PruneRegions {
  std::vector<RowList> rows;
  std::vector<std::uint32_t> laws;
  std::size_t first_fallback = 0;  ///< rows.size() where there is none
};

/// A tree of overlapping regions with the same answers and no greater cost. A leaf loses a candidate whose
/// part there lies, within `slack`, in other candidates of its law, or in ordinary ones if it is a fallback
/// region. A node whose children are leaves, one with all candidates of the other, becomes that leaf. Equal
/// leaves are written once.
SearchTree pruneTree(CellGeometry& geometry, const PruneRegions& regions, double slack,
                     const SearchTree& tree);

}  // namespace polyfly
