#include "offline_mpt/search_tree.hpp"

#include <exception>
#include <optional>
#include <utility>
#include <vector>

#include "tree/grow_tree.hpp"
#include "tree/tree_group.hpp"

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

std::vector<TreeOptions> triedTrees(const TreeOptions& options) {
  std::vector<TreeOptions> tried(1, options);
  if (options.mode != TreeMode::kSmall) return tried;
  for (const std::uint64_t planes : kSmallPlanesTried) {
    if (planes <= options.planes_tried) continue;
    tried.push_back(options);
    tried.back().planes_tried = planes;
  }
  return tried;
}

SearchTree buildTree(const TreeRegions& regions, const TreeOptions& options) {
  std::optional<SearchTree> best;
  std::uint64_t pivots = 0;
  const auto cost = [](const SearchTree& one) { return std::make_pair(one.worst, one.nodes.size()); };
  for (const TreeOptions& tried : triedTrees(options)) {
    SearchTree tree = growTree(regions, tried);
    const bool is_stopped = tree.end == TreeEnd::kStopped;
    pivots += tree.pivots;
    if (!best || (!is_stopped && cost(tree) < cost(*best))) best = std::move(tree);
    if (is_stopped) break;
  }
  best->pivots = pivots;
  return std::move(*best);
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
