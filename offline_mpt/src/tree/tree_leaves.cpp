#include "tree/tree_leaves.hpp"

#include <algorithm>

namespace polyfly {
namespace {

constexpr std::size_t kHashFactor = 0x9e3779b97f4a7c15u;

}  // namespace

std::uint32_t LeafWriter::write(const std::uint32_t* candidates, const std::uint32_t* tests,
                                std::uint32_t count) {
  std::size_t hash = count;
  for (std::uint32_t k = 0; k < count; ++k)
    hash = (hash * kHashFactor + candidates[k]) * kHashFactor + tests[k];
  const auto [begin, end] = written_.equal_range(hash);
  for (auto one = begin; one != end; ++one) {
    const MapContent::Leaf& other = tree_.leaves[one->second];
    const auto place = static_cast<std::ptrdiff_t>(other.first);
    if (other.count == count &&
        std::equal(candidates, candidates + count, tree_.candidates.begin() + place) &&
        std::equal(tests, tests + count, tree_.tests.begin() + place))
      return one->second;
  }
  const auto index = static_cast<std::uint32_t>(tree_.leaves.size());
  tree_.leaves.push_back({static_cast<std::uint32_t>(tree_.candidates.size()), count});
  tree_.candidates.insert(tree_.candidates.end(), candidates, candidates + count);
  tree_.tests.insert(tree_.tests.end(), tests, tests + count);
  written_.emplace(hash, index);
  return index;
}

std::uint64_t worstLookUp(const SearchTree& tree, const TreeRegions& regions) {
  std::vector<std::uint64_t> depth(tree.nodes.size(), 0);
  std::uint64_t worst = 0;
  const auto reach = [&](std::uint32_t child, std::uint64_t above) {
    if ((child & MapContent::kLeaf) == 0) {
      depth[child] = above;
      return;
    }
    const MapContent::Leaf& leaf = tree.leaves[child & ~MapContent::kLeaf];
    std::uint64_t cost = above;
    for (std::size_t k = leaf.first; k < std::size_t{leaf.first} + leaf.count; ++k) {
      const auto rows = static_cast<std::uint32_t>(regions.rows[tree.candidates[k]].size());
      cost += tree.tests.empty() ? rows : testedRows(tree.tests[k], rows);
    }
    worst = std::max(worst, cost);
  };
  reach(tree.root, 0);
  // Children follow their parents.
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    reach(tree.nodes[i].below, depth[i] + 1);
    reach(tree.nodes[i].above, depth[i] + 1);
  }
  return worst;
}

}  // namespace polyfly
