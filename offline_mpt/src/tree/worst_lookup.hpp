#pragma once

#include <cstdint>

#include "offline_mpt/search_tree.hpp"

namespace polyfly {

/// Half-spaces that the worst look-up evaluates: nodes on the path, and rows of the leaf's candidates.
std::uint64_t worstLookup(const SearchTree& tree, const TreeRegions& regions);

}  // namespace polyfly
