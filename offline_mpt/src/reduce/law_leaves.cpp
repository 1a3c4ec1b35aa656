#include "reduce/law_leaves.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace polyfly {
namespace {

class LawJoiner {
 public:
  LawJoiner(CellGeometry& geometry, const TreeRegions& regions, const PruneRegions& laws, const RowList& box,
            double slack, const SearchTree& tree)
      : geometry_(geometry), regions_(regions), laws_(laws), box_(box), slack_(slack), tree_(tree) {}

  SearchTree run(std::vector<LawCell>& cells) {
    result_.root = descend(tree_.root, 0);
    writeLeaf(result_.root);
    for (MapContent::Node& node : result_.nodes) {
      writeLeaf(node.below);
      writeLeaf(node.above);
    }
    cells = std::move(cells_);
    return std::move(result_);
  }

 private:
  /// A leaf, or what becomes one. Without a law it is the tree's leaf `number`.
  struct Part {
    std::optional<std::uint32_t> law;
    std::uint32_t number = 0;
    RowList path;
    /// The region that holds all of it, where it is known.
    std::optional<std::uint32_t> holder;
  };

  static bool isLeaf(std::uint32_t child) { return (child & MapContent::kLeaf) != 0; }

  std::uint32_t descend(std::uint32_t child, std::uint32_t depth) {
    if (isLeaf(child)) return addPart(leafAt(child & ~MapContent::kLeaf), depth);
    const MapContent::Node& node = tree_.nodes[child];
    const std::size_t index = result_.nodes.size(), part = parts_.size();
    const std::uint32_t deepest = std::exchange(result_.depth, 0);
    result_.nodes.push_back({node.plane, 0, 0});
    path_.push_back(static_cast<std::int32_t>(node.plane) + 1);
    const std::uint32_t below = descend(node.below, depth + 1);
    path_.back() = -path_.back();
    const std::uint32_t above = descend(node.above, depth + 1);
    path_.pop_back();
    if (isLeaf(below) && isLeaf(above)) {
      Part joined = parts_[part];
      const Part& other = parts_[part + 1];
      if (joined.law && joined.law == other.law) {
        joined.path = path_;
        if (joined.holder != other.holder) joined.holder.reset();
        parts_.resize(part);
        result_.nodes.pop_back();
        result_.depth = deepest;
        return addPart(std::move(joined), depth);
      }
    }
    result_.depth = std::max(deepest, result_.depth);
    result_.nodes[index].below = below;
    result_.nodes[index].above = above;
    return static_cast<std::uint32_t>(index);
  }

  std::uint32_t addPart(Part part, std::uint32_t depth) {
    result_.depth = std::max(result_.depth, depth);
    parts_.push_back(std::move(part));
    return static_cast<std::uint32_t>(parts_.size() - 1) | MapContent::kLeaf;
  }

  Part leafAt(std::uint32_t number) {
    const MapContent::Leaf& leaf = tree_.leaves[number];
    Part part{std::nullopt, number, path_, std::nullopt};
    if (leaf.count == 0) return part;
    const auto first = tree_.candidates.begin() + leaf.first;
    const std::uint32_t law = laws_.laws[*first];
    if (leaf.count == 1 && tree_.tests[leaf.first] == 0) {
      part.law = law;
      part.holder = *first;
      return part;
    }
    std::vector<const RowList*> cover;
    for (auto region = first; region != first + leaf.count; ++region) {
      if (laws_.laws[*region] != law) return part;
      cover.push_back(&regions_.rows[*region]);
    }
    ConvexCell cell;
    cell.rows = path_;
    geometry_.describe(cell);
    if (cell.radius > tolerance::kEmptyInterior && geometry_.covered(cell, cover, slack_)) part.law = law;
    return part;
  }

  /// Writes the leaf that a child is, if it is one.
  void writeLeaf(std::uint32_t& child) {
    if (!isLeaf(child)) return;
    const Part& part = parts_[child & ~MapContent::kLeaf];
    child = static_cast<std::uint32_t>(result_.leaves.size()) | MapContent::kLeaf;
    const auto next = static_cast<std::uint32_t>(result_.candidates.size());
    if (part.law) {
      result_.leaves.push_back({next, 1});
      result_.candidates.push_back(holderOf(part));
      result_.tests.push_back(0);
      return;
    }
    const MapContent::Leaf& leaf = tree_.leaves[part.number];
    result_.leaves.push_back({next, leaf.count});
    const auto first = static_cast<std::ptrdiff_t>(leaf.first);
    const auto last = first + static_cast<std::ptrdiff_t>(leaf.count);
    result_.candidates.insert(result_.candidates.end(), tree_.candidates.begin() + first,
                              tree_.candidates.begin() + last);
    result_.tests.insert(result_.tests.end(), tree_.tests.begin() + first, tree_.tests.begin() + last);
  }

  /// A region with the law that holds the cell: one of the regions, or else the cell.
  std::uint32_t holderOf(const Part& part) {
    if (part.holder) return *part.holder;
    ConvexCell cell;
    cell.rows = part.path;
    geometry_.describe(cell);
    for (std::uint32_t region = 0; region < regions_.rows.size(); ++region) {
      if (laws_.laws[region] != *part.law) continue;
      const RowList& rows = regions_.rows[region];
      if (std::all_of(rows.begin(), rows.end(),
                      [&](std::int32_t row) { return geometry_.holdsOn(row, cell, slack_); }))
        return region;
    }
    cell.rows.insert(cell.rows.end(), box_.begin(), box_.end());
    cell.rows = geometry_.minimal(cell);
    cells_.push_back({std::move(cell), *part.law});
    return static_cast<std::uint32_t>(regions_.rows.size() + cells_.size() - 1);
  }

  CellGeometry& geometry_;
  const TreeRegions& regions_;
  const PruneRegions& laws_;
  const RowList& box_;
  double slack_;
  const SearchTree& tree_;
  SearchTree result_;
  RowList path_;
  // Leaves in the order of descents.
  std::vector<Part> parts_;
  std::vector<LawCell> cells_;
};

}  // namespace

SearchTree joinByLaw(CellGeometry& geometry, const TreeRegions& regions, const PruneRegions& laws,
                     const RowList& box, double slack, const SearchTree& tree, std::vector<LawCell>& cells) {
  return LawJoiner(geometry, regions, laws, box, slack, tree).run(cells);
}

}  // namespace polyfly
