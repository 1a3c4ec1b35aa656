#include "offline_mpt/search_tree.hpp"

#include <utility>

#include "tree/grow_tree.hpp"

namespace polyfly {
namespace {

// TreeOptions::planes_tried of further trees of kSmall, where that is more. Estimates may rank the best plane as low as
// the last of them. The best plane of a cell need not lead to the best tree, so that fewer may do better.
constexpr std::uint64_t kSmallPlanesTried[] = {4, 20};

}  // namespace

void moveTree(SearchTree tree, MapContent& content) {
  content.root = tree.root;
  content.nodes = std::move(tree.nodes);
  content.leaves = std::move(tree.leaves);
  content.candidates = std::move(tree.candidates);
  content.tests = std::move(tree.tests);
}

SearchTree buildTree(const TreeRegions& regions, const TreeOptions& options) {
  SearchTree tree = growTree(regions, options);
  if (options.mode != TreeMode::kSmall || tree.end == TreeEnd::kStopped) return tree;
  const auto cost = [](const SearchTree& one) { return std::make_pair(one.worst, one.nodes.size()); };
  for (const std::uint64_t tried : kSmallPlanesTried) {
    if (tried <= options.planes_tried) continue;
    TreeOptions more = options;
    more.planes_tried = tried;
    SearchTree other = growTree(regions, more);
    if (other.end == TreeEnd::kStopped) break;
    const std::uint64_t pivots = tree.pivots + other.pivots;
    if (cost(other) < cost(tree)) tree = std::move(other);
    tree.pivots = pivots;
  }
  return tree;
}

}  // namespace polyfly
