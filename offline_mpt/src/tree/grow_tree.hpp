#pragma once

#include "offline_mpt/search_tree.hpp"

namespace polyfly {

/// One tree, as buildTree says.
SearchTree growTree(const TreeRegions& regions, const TreeOptions& options);

}  // namespace polyfly
