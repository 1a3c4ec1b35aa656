#include "tree/grow_tree.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <queue>
#include <utility>

#include "support/in_parallel.hpp"
#include "tree/cell_splitter.hpp"
#include "tree/growth_limit.hpp"
#include "tree/tree_leaves.hpp"

namespace polyfly {
namespace {

// Cells of a batch, which the threads share. It does not depend on their number, nor does the tree.
constexpr std::size_t kBatch = 32;
// The same in kFast, where a batch may take little longer than the limit.
constexpr std::size_t kFastBatch = 4;
// A batch takes cells whose look-ups cost at least this share of the worst.
constexpr double kNearWorst = 0.75;
// A cell with more members is split by all threads together.
constexpr std::size_t kLargeCell = 2000;
// Such cells of a batch, one of them in kFast.
constexpr std::size_t kLargeBatch = 4;

// Of an allocation, besides its content.
constexpr std::uint64_t kAllocation = 16;

/// What a cell takes in memory while the tree grows.
std::uint64_t memoryOf(const Cell& cell) {
  std::uint64_t sum = sizeof(std::int32_t) * cell.path.size() + kAllocation;
  for (const CellMember& member : cell.members) {
    sum += sizeof(CellMember) + 4 * kAllocation + sizeof(std::int32_t) * member.bounds() +
           sizeof(double) * (member.inner.size() + member.points.size());
  }
  return sum;
}

/// What a leaf takes in a map file.
std::uint64_t bytesOf(std::uint32_t members) {
  return sizeof(MapContent::Leaf) + 2 * sizeof(std::uint32_t) * members;
}

class TreeGrower {
 public:
  TreeGrower(const TreeRegions& regions, const TreeOptions& options)
      : regions_(regions), options_(options), splitter_(regions, options), limit_(regions, options) {}

  SearchTree run() {
    addCell(splitter_.whole());
    now_.pivots = splitter_.pivots();
    TreeEnd end = grow(limit_);
    if (end == TreeEnd::kMemory) end = growParts();
    finishLeaves(0);
    SearchTree tree;
    LeafWriter leaves(tree);
    tree.root = layOut(0, tree, leaves);
    tree.worst = worstLookUp(tree, regions_);
    if (options_.all_rows) tree.tests.clear();
    tree.end = end;
    tree.pivots = now_.pivots;
    return tree;
  }

 private:
  static constexpr std::uint32_t kUnsplit = ~std::uint32_t{0};
  static constexpr std::uint32_t kFinished = kUnsplit - 1;

  struct GrowingCell {
    std::uint64_t memory = 0;
    std::uint32_t members = 0;
    std::uint32_t depth = 0;
    /// Its node, or kUnsplit, or kFinished: of a leaf only what a map holds is left.
    std::uint32_t node = kUnsplit;
    /// Of a finished leaf, its first one of the candidates and tests that are kept.
    std::size_t first_kept = 0;
    /// Until it is split or finished.
    std::unique_ptr<Cell> cell;
  };

  /// A cell that may be split, by the greatest cost of its look-ups.
  struct Open {
    std::uint64_t cost = 0;  // half-spaces
    std::uint32_t cell = 0;

    bool operator<(const Open& other) const {
      return cost != other.cost ? cost < other.cost : cell > other.cell;
    }
  };

  TreeEnd grow(GrowthLimit& limit) {
    for (;;) {
      if (open_.empty()) return TreeEnd::kNoGain;
      if (options_.stop != nullptr && options_.stop->load()) return TreeEnd::kStopped;
      now_.nodes = nodes_.size();
      now_.worst = open_.top().cost;
      if (const std::optional<TreeEnd> end = limit.reached(now_)) return *end;
      splitBatch(takeBatch(limit.nodes() - nodes_.size()));
      reportProgress();
    }
  }

  /// Where the cells of the whole tree take too much memory: grows from one cell after the other, and keeps of its
  /// leaves only what a map holds. Each gets the share of what is left that its look-ups have of all.
  TreeEnd growParts() {
    std::vector<Open> parts;
    double left = 0.0;
    for (; !open_.empty(); open_.pop()) {
      parts.push_back(open_.top());
      left += static_cast<double>(open_.top().cost);
    }
    TreeEnd end = TreeEnd::kNoGain;
    std::uint64_t worst = 0;
    for (const Open& part : parts) {
      const std::size_t first = cells_.size();
      const double share = static_cast<double>(part.cost) / left;
      left -= static_cast<double>(part.cost);
      now_.nodes = nodes_.size();
      GrowthLimit limit = limit_.part(now_, std::min(share, 1.0), options_.memory_limit);
      open_.push(part);
      const TreeEnd reached = grow(limit);
      const std::uint64_t cost = open_.empty() ? 0 : open_.top().cost;
      open_ = {};
      finishLeaves(first);
      if (cost <= worst) continue;
      worst = cost;
      end = reached;
    }
    return end;
  }

  void addCell(Cell cell) {
    const auto number = static_cast<std::uint32_t>(cells_.size());
    const auto members = static_cast<std::uint32_t>(cell.members.size());
    const auto depth = static_cast<std::uint32_t>(cell.path.size());
    const std::uint64_t memory = memoryOf(cell);
    if (members > 1) open_.push({depth + splitter_.tests(cell), number});
    now_.bytes += bytesOf(members);
    now_.memory += memory;
    cells_.push_back({memory, members, depth, kUnsplit, 0, std::make_unique<Cell>(std::move(cell))});
  }

  bool isLarge(std::uint32_t cell) const { return cells_[cell].members > kLargeCell; }

  /// At most so many cells, and at least one. All of them are large, or none is.
  std::vector<std::uint32_t> takeBatch(std::uint64_t limit) {
    std::vector<std::uint32_t> batch;
    const auto least = static_cast<std::uint64_t>(kNearWorst * static_cast<double>(open_.top().cost));
    const bool large = isLarge(open_.top().cell);
    const bool fast = options_.mode == TreeMode::kFast;
    const std::uint64_t most = large ? (fast ? 1 : kLargeBatch) : (fast ? kFastBatch : kBatch);
    while (batch.size() < std::min(most, limit) && !open_.empty() && open_.top().cost >= least &&
           isLarge(open_.top().cell) == large) {
      batch.push_back(open_.top().cell);
      open_.pop();
    }
    return batch;
  }

  void splitBatch(const std::vector<std::uint32_t>& batch) {
    std::vector<std::optional<CellSplit>> splits(batch.size());
    const std::uint64_t before = splitter_.pivots();
    if (isLarge(batch.front()) || batch.size() == 1) {
      for (std::size_t i = 0; i < batch.size(); ++i) {
        Cell& cell = *cells_[batch[i]].cell;
        splits[i] = isLarge(batch[i]) ? splitter_.splitTogether(cell) : splitter_.split(cell, 0);
      }
    } else {
      inParallel(batch.size(), options_.threads, nullptr, {}, [&](std::size_t thread, std::uint64_t i) {
        splits[i] = splitter_.split(*cells_[batch[i]].cell, thread);
      });
    }
    now_.pivots += splitter_.pivots() - before;
    for (std::size_t i = 0; i < batch.size(); ++i) keepSplit(batch[i], std::move(splits[i]));
  }

  void keepSplit(std::uint32_t number, std::optional<CellSplit> split) {
    GrowingCell& parent = cells_[number];
    now_.memory -= parent.memory;
    if (!split) {
      parent.memory = memoryOf(*parent.cell);
      now_.memory += parent.memory;
      return;
    }
    now_.bytes -= bytesOf(parent.members);
    parent.node = static_cast<std::uint32_t>(nodes_.size());
    parent.cell.reset();
    nodes_.push_back(static_cast<std::uint32_t>(split->plane));
    now_.bytes += sizeof(MapContent::Node);
    addCell(std::move(split->below));
    addCell(std::move(split->above));
  }

  void reportProgress() const {
    if (options_.progress)
      options_.progress(std::min<std::uint64_t>(nodes_.size(), limit_.nodes()), limit_.nodes());
  }

  /// Of the cells from `first` on, those that are leaves: of them is kept only what a map holds.
  void finishLeaves(std::size_t first) {
    std::vector<std::uint32_t> leaves;
    for (std::size_t cell = first; cell < cells_.size(); ++cell) {
      if (cells_[cell].node == kUnsplit) leaves.push_back(static_cast<std::uint32_t>(cell));
    }
    const std::uint64_t before = splitter_.pivots();
    inParallel(leaves.size(), options_.threads, nullptr, {}, [&](std::size_t thread, std::uint64_t i) {
      splitter_.finishLeaf(*cells_[leaves[i]].cell, thread);
    });
    now_.pivots += splitter_.pivots() - before;
    for (const std::uint32_t leaf : leaves) keep(leaf);
  }

  void keep(std::uint32_t number) {
    GrowingCell& leaf = cells_[number];
    now_.memory -= leaf.memory;
    leaf.node = kFinished;
    leaf.first_kept = candidates_.size();
    for (const CellMember& member : leaf.cell->members) {
      candidates_.push_back(member.region);
      tests_.push_back(options_.all_rows ? MapContent::kAllRows : splitter_.testsOf(member));
    }
    leaf.cell.reset();
  }

  /// Nodes in the order of descents, below first.
  std::uint32_t layOut(std::uint32_t cell, SearchTree& tree, LeafWriter& leaves) {
    const GrowingCell& part = cells_[cell];
    if (part.node == kFinished) {
      tree.depth = std::max(tree.depth, part.depth);
      return leaves.write(candidates_.data() + part.first_kept, tests_.data() + part.first_kept,
                          part.members) |
             MapContent::kLeaf;
    }
    const auto index = static_cast<std::uint32_t>(tree.nodes.size());
    tree.nodes.push_back({nodes_[part.node], 0, 0});
    const std::uint32_t below = layOut(2 * part.node + 1, tree, leaves);
    const std::uint32_t above = layOut(2 * part.node + 2, tree, leaves);
    tree.nodes[index].below = below;
    tree.nodes[index].above = above;
    return index;
  }

  const TreeRegions& regions_;
  const TreeOptions& options_;
  CellSplitter splitter_;
  GrowthLimit limit_;
  Growth now_;
  std::vector<GrowingCell> cells_;
  std::vector<std::uint32_t> candidates_, tests_;
  std::vector<std::uint32_t> nodes_;  // planes; the children of node i are cells 2 i + 1 and 2 i + 2
  std::priority_queue<Open> open_;
};

}  // namespace

SearchTree growTree(const TreeRegions& regions, const TreeOptions& options) {
  return TreeGrower(regions, options).run();
}

}  // namespace polyfly
