#include "offline_mpt/search_tree.hpp"

#include <algorithm>
#include <exception>
#include <utility>

#include "tree/grow_tree.hpp"
#include "tree/tree_group.hpp"

namespace polyfly {
namespace {

// TreeOptions::planes_tried of the second tree of kSmall: estimates may rank the best plane as low as this.
constexpr std::uint64_t kSmallPlanesTried = 20;

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
  TreeOptions more = options;
  more.planes_tried = std::max(options.planes_tried, kSmallPlanesTried);
  SearchTree other = growTree(regions, more);
  const std::uint64_t pivots = tree.pivots + other.pivots;
  const auto cost = [](const SearchTree& one) { return std::make_pair(one.worst, one.nodes.size()); };
  if (other.end != TreeEnd::kStopped && cost(other) < cost(tree)) tree = std::move(other);
  tree.pivots = pivots;
  return tree;
}

void runTreeProcess(ProcessGroup& group, int threads) {
  try {
    while (const auto bytes = GroupExchange::task(group)) {
      TreeTask task = readTask(*bytes);
      task.options.threads = threads;
      task.options.group = &group;
      growTree(task.regions, task.options);
    }
  } catch (const GroupExchange::Ended&) {  // process 0 has said why
  } catch (const std::exception& error) {
    reportFailure(error.what(), group);
  }
}

}  // namespace polyfly
