#include "reduce/prune_tree.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace polyfly {
namespace {

using Candidates = std::vector<std::uint32_t>;  // ascending

class Pruner {
 public:
  Pruner(CellGeometry& geometry, const PruneRegions& regions, double slack, const SearchTree& tree)
      : geometry_(geometry), regions_(regions), slack_(slack), tree_(tree) {}

  SearchTree run() {
    result_.root = descend(tree_.root, 0);
    writeLeaf(result_.root);
    for (MapContent::Node& node : result_.nodes) {
      writeLeaf(node.below);
      writeLeaf(node.above);
    }
    return std::move(result_);
  }

 private:
  static bool isLeaf(std::uint32_t child) { return (child & MapContent::kLeaf) != 0; }

  /// Numbers the leaf that a child is, if it is one, by order of use.
  void writeLeaf(std::uint32_t& child) {
    if (!isLeaf(child)) return;
    const auto next = static_cast<std::uint32_t>(result_.leaves.size());
    const auto [found, is_new] = number_.emplace(child, next);
    if (is_new) {
      const Candidates& candidates = leaves_[child & ~MapContent::kLeaf];
      result_.leaves.push_back({static_cast<std::uint32_t>(result_.candidates.size()),
                                static_cast<std::uint32_t>(candidates.size())});
      result_.candidates.insert(result_.candidates.end(), candidates.begin(), candidates.end());
    }
    child = found->second | MapContent::kLeaf;
  }

  std::uint32_t descend(std::uint32_t child, std::uint32_t depth) {
    if (isLeaf(child)) {
      result_.depth = std::max(result_.depth, depth);
      return addLeaf(prune(tree_.leaves[child & ~MapContent::kLeaf]));
    }
    const MapContent::Node& node = tree_.nodes[child];
    const std::size_t index = result_.nodes.size();
    const std::uint32_t deepest = std::exchange(result_.depth, 0);
    result_.nodes.push_back({node.plane, 0, 0});
    path_.push_back(static_cast<std::int32_t>(node.plane) + 1);
    const std::uint32_t below = descend(node.below, depth + 1);
    path_.back() = -path_.back();
    const std::uint32_t above = descend(node.above, depth + 1);
    path_.pop_back();
    if (isLeaf(below) && isLeaf(above)) {
      const Candidates& first = leaves_[below & ~MapContent::kLeaf];
      const Candidates& second = leaves_[above & ~MapContent::kLeaf];
      const bool first_holds = std::includes(first.begin(), first.end(), second.begin(), second.end());
      if (first_holds || std::includes(second.begin(), second.end(), first.begin(), first.end())) {
        result_.nodes.pop_back();
        result_.depth = std::max(deepest, depth);
        return first_holds ? below : above;
      }
    }
    result_.depth = std::max(deepest, result_.depth);
    result_.nodes[index].below = below;
    result_.nodes[index].above = above;
    return static_cast<std::uint32_t>(index);
  }

  Candidates prune(const MapContent::Leaf& leaf) {
    const auto first = tree_.candidates.begin() + static_cast<std::ptrdiff_t>(leaf.first);
    Candidates candidates(first, first + static_cast<std::ptrdiff_t>(leaf.count));
    std::sort(candidates.begin(), candidates.end());
    for (std::size_t i = candidates.size(); i-- > 0 && candidates.size() > 1;) {
      std::vector<const RowList*> cover;
      for (const std::uint32_t other : candidates) {
        if (other != candidates[i] && standsFor(other, candidates[i])) cover.push_back(&regions_.rows[other]);
      }
      if (!cover.empty() && isCovered(candidates[i], cover))
        candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(i));
    }
    return candidates;
  }

  bool standsFor(std::uint32_t other, std::uint32_t region) const {
    const bool is_fallback = region >= regions_.first_fallback;
    if (is_fallback && other < regions_.first_fallback) return true;
    return regions_.laws[other] == regions_.laws[region] && is_fallback == (other >= regions_.first_fallback);
  }

  bool isCovered(std::uint32_t region, const std::vector<const RowList*>& cover) {
    ConvexCell part;
    part.rows = regions_.rows[region];
    part.rows.insert(part.rows.end(), path_.begin(), path_.end());
    geometry_.describe(part);
    return part.radius > 0.0 && geometry_.covered(part, cover, slack_);
  }

  std::uint32_t addLeaf(Candidates candidates) {
    const auto [found, is_new] = known_.emplace(candidates, static_cast<std::uint32_t>(leaves_.size()));
    if (is_new) leaves_.push_back(std::move(candidates));
    return found->second | MapContent::kLeaf;
  }

  CellGeometry& geometry_;
  const PruneRegions& regions_;
  double slack_;
  const SearchTree& tree_;
  SearchTree result_;
  RowList path_;
  std::vector<Candidates> leaves_;
  std::map<Candidates, std::uint32_t> known_;
  // New number of each leaf that is used.
  std::map<std::uint32_t, std::uint32_t> number_;
};

}  // namespace

SearchTree pruneTree(CellGeometry& geometry, const PruneRegions& regions, double slack,
                     const SearchTree& tree) {
  return Pruner(geometry, regions, slack, tree).run();
}

}  // namespace polyfly
