#include "tree/worst_lookup.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace polyfly {

std::uint64_t worstLookup(const SearchTree& tree, const TreeRegions& regions) {
  constexpr std::size_t kLastBit = 31;  // stands for all further rows
  const auto leafCost = [&](const MapContent::Leaf& leaf) {
    std::uint64_t sum = 0;
    for (std::uint32_t k = leaf.first; k < leaf.first + leaf.count; ++k) {
      const std::size_t rows = regions.rows[tree.candidates[k]].size();
      for (std::size_t i = 0; i < rows; ++i)
        sum += tree.tests.empty() || (tree.tests[k] >> std::min(i, kLastBit) & 1U) != 0 ? 1 : 0;
    }
    return sum;
  };
  std::uint64_t worst = 0;
  std::vector<std::uint64_t> depth(tree.nodes.size(), 0);
  const auto reach = [&](std::uint32_t child, std::uint64_t above) {
    if ((child & MapContent::kLeaf) == 0) {
      depth[child] = above;
    } else {
      worst = std::max(worst, above + leafCost(tree.leaves[child & ~MapContent::kLeaf]));
    }
  };
  reach(tree.root, 0);
  for (std::size_t node = 0; node < tree.nodes.size(); ++node) {
    reach(tree.nodes[node].below, depth[node] + 1);
    reach(tree.nodes[node].above, depth[node] + 1);
  }
  return worst;
}

}  // namespace polyfly
