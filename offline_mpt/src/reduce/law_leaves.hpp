#pragma once

#include <cstdint>
#include <vector>

#include "offline_mpt/search_tree.hpp"
#include "reduce/cell_geometry.hpp"

namespace polyfly {

/// A cell of a tree that becomes a region.
struct LawCell {
  ConvexCell piece;
  std::uint32_t law = 0;
};

/// The tree whose subtrees of one law are leaves. Such a leaf has one candidate and tests nothing: a region that holds the
/// whole cell of the subtree, within `slack`. `cells` receives the regions that this takes; they are numbered after those
/// of `regions`. A subtree stays where its candidates have several laws, or do not cover its cell. `box` are the rows
/// of the box's sides. The tree names its tests.
SearchTree joinByLaw(CellGeometry& geometry, const TreeRegions& regions,
                     const std::vector<std::uint32_t>& laws, const RowList& box, double slack,
                     const SearchTree& tree, std::vector<LawCell>& cells);

}  // namespace polyfly
