#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "offline_mpt/search_tree.hpp"
#include "reduce/cell_geometry.hpp"

namespace polyfly {

/// Writes a search tree anew with leaves of a kind: `Leaf` is what becomes of one. Nodes whose children are leaves may
/// become leaves, from below upwards.
template <class Leaf>
class TreeRewriter {
 public:
  explicit TreeRewriter(const SearchTree& tree) : tree_(tree) {}
  virtual ~TreeRewriter() = default;
  TreeRewriter(const TreeRewriter&) = delete;
  TreeRewriter& operator=(const TreeRewriter&) = delete;

  SearchTree run() {
    result_.root = descend(tree_.root, 0);
    write(result_.root);
    for (MapContent::Node& node : result_.nodes) {
      write(node.below);
      write(node.above);
    }
    return std::move(result_);
  }

 protected:
  /// What becomes of the tree's leaf `number`, which path_ leads to.
  virtual Leaf leafAt(std::uint32_t number) = 0;
  /// The leaf in place of the node that path_ leads to, from its children; nothing: the node stays.
  virtual std::optional<Leaf> join(const Leaf& below, const Leaf& above) = 0;
  /// Number in result_ of the leaf. Leaves are asked for in the order in which nodes name them.
  virtual std::uint32_t numberOf(const Leaf& leaf) = 0;

  const SearchTree& tree_;
  SearchTree result_;
  RowList path_;

 private:
  static bool isLeaf(std::uint32_t child) { return (child & MapContent::kLeaf) != 0; }

  void write(std::uint32_t& child) {
    if (isLeaf(child)) child = numberOf(leaves_[child & ~MapContent::kLeaf]) | MapContent::kLeaf;
  }

  std::uint32_t descend(std::uint32_t child, std::uint32_t depth) {
    if (isLeaf(child)) return addLeaf(leafAt(child & ~MapContent::kLeaf), depth);
    const MapContent::Node& node = tree_.nodes[child];
    const std::size_t index = result_.nodes.size(), first = leaves_.size();
    const std::uint32_t deepest = std::exchange(result_.depth, 0);
    result_.nodes.push_back({node.plane, 0, 0});
    path_.push_back(static_cast<std::int32_t>(node.plane) + 1);
    const std::uint32_t below = descend(node.below, depth + 1);
    path_.back() = -path_.back();
    const std::uint32_t above = descend(node.above, depth + 1);
    path_.pop_back();
    if (isLeaf(below) && isLeaf(above)) {
      if (std::optional<Leaf> joined = join(leaves_[first], leaves_[first + 1])) {
        leaves_.resize(first);
        result_.nodes.pop_back();
        result_.depth = deepest;
        return addLeaf(std::move(*joined), depth);
      }
    }
    result_.depth = std::max(deepest, result_.depth);
    result_.nodes[index].below = below;
    result_.nodes[index].above = above;
    return static_cast<std::uint32_t>(index);
  }

  std::uint32_t addLeaf(Leaf leaf, std::uint32_t depth) {
    result_.depth = std::max(result_.depth, depth);
    leaves_.push_back(std::move(leaf));
    return static_cast<std::uint32_t>(leaves_.size() - 1) | MapContent::kLeaf;
  }

  // In the order of descents.
  std::vector<Leaf> leaves_;
};

}  // namespace polyfly
