#pragma once

#include "offline_mpt/search_tree.hpp"

namespace polyfly {

/// One tree, as buildTree says. All processes of a group call it alike; it returns the tree in each of them.
SearchTree growTree(const TreeRegions& regions, const TreeOptions& options);

}  // namespace polyfly
