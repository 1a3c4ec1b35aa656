#include "reduce/law_leaves.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "reduce/rewrite_tree.hpp"
#include "reduce/tolerances.hpp"

namespace polyfly {
namespace {

/// A leaf, or what becomes one. Without a law it is the tree's leaf `number`.
struct LawLeaf {
  std::optional<std::uint32_t> law;
  std::uint32_t number = 0;
  RowList path;
  /// The region that holds all of it, where it is known.
  std::optional<std::uint32_t> holder;
};

class LawJoiner final : public TreeRewriter<LawLeaf> {
 public:
  LawJoiner(CellGeometry& geometry, const TreeRegions& regions, const std::vector<std::uint32_t>& laws,
            const RowList& box, double slack, const SearchTree& tree)
      : TreeRewriter(tree), geometry_(geometry), regions_(regions), laws_(laws), box_(box), slack_(slack) {}

  std::vector<LawCell> takeCells() { return std::move(cells_); }

 private:
  LawLeaf leafAt(std::uint32_t number) override {
    const MapContent::Leaf& leaf = tree_.leaves[number];
    LawLeaf part{std::nullopt, number, path_, std::nullopt};
    if (leaf.count == 0) return part;
    const auto first = tree_.candidates.begin() + leaf.first;
    const std::uint32_t law = laws_[*first];
    if (leaf.count == 1 && tree_.tests[leaf.first] == 0) {
      part.law = law;
      part.holder = *first;
      return part;
    }
    std::vector<const RowList*> cover;
    for (auto region = first; region != first + leaf.count; ++region) {
      if (laws_[*region] != law) return part;
      cover.push_back(&regions_.rows[*region]);
    }
    ConvexCell cell;
    cell.rows = path_;
    geometry_.describe(cell);
    if (cell.radius > tolerance::kEmptyInterior && geometry_.covered(cell, cover, slack_)) part.law = law;
    return part;
  }

  std::optional<LawLeaf> join(const LawLeaf& below, const LawLeaf& above) override {
    if (!below.law || below.law != above.law) return std::nullopt;
    LawLeaf joined = below;
    joined.path = path_;
    if (below.holder != above.holder) joined.holder.reset();
    return joined;
  }

  std::uint32_t numberOf(const LawLeaf& part) override {
    const auto number = static_cast<std::uint32_t>(result_.leaves.size());
    const auto next = static_cast<std::uint32_t>(result_.candidates.size());
    if (part.law) {
      result_.leaves.push_back({next, 1});
      result_.candidates.push_back(holderOf(part));
      result_.tests.push_back(0);
      return number;
    }
    const MapContent::Leaf& leaf = tree_.leaves[part.number];
    result_.leaves.push_back({next, leaf.count});
    const auto first = static_cast<std::ptrdiff_t>(leaf.first);
    const auto last = first + static_cast<std::ptrdiff_t>(leaf.count);
    result_.candidates.insert(result_.candidates.end(), tree_.candidates.begin() + first,
                              tree_.candidates.begin() + last);
    result_.tests.insert(result_.tests.end(), tree_.tests.begin() + first, tree_.tests.begin() + last);
    return number;
  }

  /// A region with the law that holds the cell: one of the regions, or else the cell.
  std::uint32_t holderOf(const LawLeaf& part) {
    if (part.holder) return *part.holder;
    ConvexCell cell;
    cell.rows = part.path;
    geometry_.describe(cell);
    for (std::uint32_t region = 0; region < regions_.rows.size(); ++region) {
      if (laws_[region] != *part.law) continue;
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
  const std::vector<std::uint32_t>& laws_;
  const RowList& box_;
  double slack_;
  std::vector<LawCell> cells_;
};

}  // namespace

SearchTree joinByLaw(CellGeometry& geometry, const TreeRegions& regions,
                     const std::vector<std::uint32_t>& laws, const RowList& box, double slack,
                     const SearchTree& tree, std::vector<LawCell>& cells) {
  LawJoiner joiner(geometry, regions, laws, box, slack, tree);
  SearchTree joined = joiner.run();
  cells = joiner.takeCells();
  return joined;
}

}  // namespace polyfly
