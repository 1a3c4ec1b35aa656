#pragma once

#include <vector>

#include "offline_mpt/search_tree.hpp"

namespace polyfly {

/// One tree, as buildTree says. All processes of a group call it alike; it returns the tree in each of them.
SearchTree growTree(const TreeRegions& regions, const TreeOptions& options);

/// Options of the trees of which the best is kept, the given ones first: several in kSmall.
std::vector<TreeOptions> triedTrees(const TreeOptions& options);

}  // namespace polyfly
