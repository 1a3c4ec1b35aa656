#include "offline_mpt/search_tree.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <queue>

#include "support/in_parallel.hpp"
#include "tree/cell_splitter.hpp"

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

// Default limits of nodes, per region and at least.
constexpr std::uint64_t kSmallNodes = 64;
constexpr std::uint64_t kOtherNodes = 2;
constexpr std::uint64_t kLeastNodes = 4096;
// kFast: pivots per pivot of the exploration, and at least, which take some 20 ms. The leaves take about half as many
// again once the tree has grown.
constexpr double kFastPivots = 1.0;
constexpr std::uint64_t kLeastPivots = 40000;
// kAuto: bytes of the tree per byte of the regions, and in any case.
constexpr std::uint64_t kAutoBytes = 3;
constexpr std::uint64_t kFreeBytes = 65536;
// kAuto: the worst case after a doubling of the nodes, relative to the one before, above which more nodes gain little.
constexpr double kLittleGain = 0.85;

// Of TreeOptions::memory_limit, the share that all cells may take before the tree grows in one after the other.
constexpr double kWholeShare = 2.0 / 3.0;
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
std::uint64_t bytesOf(const Cell& cell) {
  return sizeof(MapContent::Leaf) + 2 * sizeof(std::uint32_t) * cell.members.size();
}

std::uint64_t bytesOf(const TreeRegions& regions) {
  std::uint64_t rows = 0;
  for (const auto& list : regions.rows) rows += list.size();
  return sizeof(double) * regions.planes.size() + sizeof(std::int32_t) * rows +
         sizeof(MapContent::Region) * regions.rows.size();
}

/// What a growing tree has taken.
struct Growth {
  std::uint64_t nodes = 0;
  std::uint64_t pivots = 0;
  std::uint64_t bytes = 0;   // of the tree in a map file
  std::uint64_t memory = 0;  // of the cells [bytes]
  std::uint64_t worst = 0;   // half-spaces of the worst look-up
};

/// When a tree has grown enough.
class GrowthLimit {
 public:
  GrowthLimit(const TreeRegions& regions, const TreeOptions& options)
      : mode_(options.mode),
        memory_(static_cast<std::uint64_t>(kWholeShare * static_cast<double>(options.memory_limit))) {
    most_.nodes = options.node_limit;
    const std::uint64_t per_region = mode_ == TreeMode::kSmall ? kSmallNodes : kOtherNodes;
    if (most_.nodes == 0) most_.nodes = std::max(kLeastNodes, per_region * regions.rows.size());
    if (mode_ == TreeMode::kNone) most_.nodes = 0;
    const double explored = kFastPivots * static_cast<double>(options.explored_pivots);
    most_.pivots = std::max(kLeastPivots, static_cast<std::uint64_t>(explored));
    most_.bytes = kFreeBytes + kAutoBytes * bytesOf(regions);
    checked_nodes_ = std::max<std::uint64_t>(kLeastNodes, regions.rows.size() / 4);
  }

  /// For a part of the tree with a share of what is left, 0 .. 1, which may take the memory up to the limit.
  GrowthLimit part(const Growth& now, double share, std::uint64_t memory_limit) const {
    const auto shared = [share](std::uint64_t most, std::uint64_t used) {
      return used + static_cast<std::uint64_t>(share * static_cast<double>(most - std::min(most, used)));
    };
    GrowthLimit limit = *this;
    limit.most_.nodes = shared(most_.nodes, now.nodes);
    limit.most_.pivots = shared(most_.pivots, now.pivots);
    limit.most_.bytes = shared(most_.bytes, now.bytes);
    limit.memory_ = memory_limit;
    limit.checked_nodes_ = std::numeric_limits<std::uint64_t>::max();
    return limit;
  }

  std::uint64_t nodes() const { return most_.nodes; }

  /// Which limit a tree has reached.
  std::optional<TreeEnd> reached(const Growth& now) {
    if (now.nodes >= most_.nodes) return TreeEnd::kNodes;
    if (now.memory >= memory_) return TreeEnd::kMemory;
    if (mode_ == TreeMode::kFast && now.pivots >= most_.pivots) return TreeEnd::kPivots;
    if (mode_ == TreeMode::kAuto && now.bytes >= most_.bytes) return TreeEnd::kBytes;
    if (mode_ == TreeMode::kAuto && gainsLittle(now)) return TreeEnd::kLittleGain;
    return std::nullopt;
  }

 private:
  bool gainsLittle(const Growth& now) {
    if (now.nodes < checked_nodes_) return false;
    checked_nodes_ = 2 * now.nodes;
    const bool gains_little = checked_worst_ > 0 && static_cast<double>(now.worst) >
                                                        kLittleGain * static_cast<double>(checked_worst_);
    checked_worst_ = now.worst;
    return gains_little;
  }

  TreeMode mode_;
  Growth most_;
  std::uint64_t memory_;
  std::uint64_t checked_nodes_ = 0;  // when the gain is looked at next
  std::uint64_t checked_worst_ = 0;
};

class TreeGrower {
 public:
  TreeGrower(const TreeRegions& regions, const TreeOptions& options)
      : regions_(regions), options_(options), splitter_(regions, options), limit_(regions, options) {}

  SearchTree run() {
    addCell(splitter_.whole(), 0);
    TreeEnd end = grow(limit_);
    if (end == TreeEnd::kMemory) end = growParts();
    finishLeaves(0);
    SearchTree tree;
    tree.root = layOut(0, tree);
    tree.end = end;
    tree.pivots = splitter_.pivots();
    return tree;
  }

 private:
  static constexpr std::uint32_t kUnsplit = ~std::uint32_t{0};

  /// A finished leaf: which of the candidates and tests that are kept are its own.
  struct Leaf {
    std::uint32_t depth = 0;
    std::uint32_t count = 0;
    std::size_t first = 0;
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
      now_.pivots = splitter_.pivots();
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
      now_.pivots = splitter_.pivots();
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

  void addCell(Cell cell, std::uint32_t number) {
    const std::uint64_t cost = cell.path.size() + splitter_.tests(cell);
    now_.bytes += bytesOf(cell);
    now_.memory += memoryOf(cell);
    cells_.push_back(std::make_unique<Cell>(std::move(cell)));
    split_by_.push_back(kUnsplit);
    if (cells_.back()->members.size() > 1) open_.push({cost, number});
  }

  /// At most so many cells, and at least one.
  std::vector<std::uint32_t> takeBatch(std::uint64_t limit) {
    std::vector<std::uint32_t> batch;
    const auto least = static_cast<std::uint64_t>(kNearWorst * static_cast<double>(open_.top().cost));
    const std::uint64_t most =
        std::min<std::uint64_t>(options_.mode == TreeMode::kFast ? kFastBatch : kBatch, limit);
    while (batch.size() < most && !open_.empty() && open_.top().cost >= least) {
      const bool large = cells_[open_.top().cell]->members.size() > kLargeCell;
      if (large && !batch.empty()) break;
      batch.push_back(open_.top().cell);
      open_.pop();
      if (large) break;
    }
    return batch;
  }

  void splitBatch(const std::vector<std::uint32_t>& batch) {
    std::vector<std::optional<CellSplit>> splits(batch.size());
    for (const std::uint32_t cell : batch) {
      now_.bytes -= bytesOf(*cells_[cell]);
      now_.memory -= memoryOf(*cells_[cell]);
    }
    if (batch.size() == 1) {
      Cell& cell = *cells_[batch.front()];
      splits.front() =
          cell.members.size() > kLargeCell ? splitter_.splitTogether(cell) : splitter_.split(cell, 0);
    } else {
      inParallel(batch.size(), options_.threads, nullptr, {}, [&](std::size_t thread, std::uint64_t i) {
        splits[i] = splitter_.split(*cells_[batch[i]], thread);
      });
    }
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (splits[i]) {
        addNode(batch[i], std::move(*splits[i]));
      } else {
        now_.bytes += bytesOf(*cells_[batch[i]]);
        now_.memory += memoryOf(*cells_[batch[i]]);
      }
    }
  }

  void addNode(std::uint32_t cell, CellSplit split) {
    const auto node = static_cast<std::uint32_t>(nodes_.size());
    split_by_[cell] = node;
    cells_[cell].reset();
    nodes_.push_back(static_cast<std::uint32_t>(split.plane));
    now_.bytes += sizeof(MapContent::Node);
    addCell(std::move(split.below), 2 * node + 1);
    addCell(std::move(split.above), 2 * node + 2);
  }

  void reportProgress() const {
    if (options_.progress)
      options_.progress(std::min<std::uint64_t>(nodes_.size(), limit_.nodes()), limit_.nodes());
  }

  /// Of the cells from `first` on, those that are leaves: of them is kept only what a map holds.
  void finishLeaves(std::size_t first) {
    for (std::size_t cell = first; cell < cells_.size(); ++cell)  // before their rows become more
      now_.memory -= cells_[cell] ? memoryOf(*cells_[cell]) : 0;
    inParallel(cells_.size() - first, options_.threads, nullptr, {},
               [&](std::size_t thread, std::uint64_t i) {
                 if (cells_[first + i]) splitter_.finishLeaf(*cells_[first + i], thread);
               });
    leaves_.resize(cells_.size());
    for (std::size_t cell = first; cell < cells_.size(); ++cell) {
      if (!cells_[cell]) continue;
      leaves_[cell] = keep(*cells_[cell]);
      cells_[cell].reset();
    }
  }

  Leaf keep(const Cell& cell) {
    const Leaf leaf{static_cast<std::uint32_t>(cell.path.size()),
                    static_cast<std::uint32_t>(cell.members.size()), candidates_.size()};
    for (const CellMember& member : cell.members) {
      candidates_.push_back(member.region);
      if (!options_.all_rows) tests_.push_back(testsOf(member));
    }
    return leaf;
  }

  /// Nodes in the order of descents, below first.
  std::uint32_t layOut(std::uint32_t cell, SearchTree& tree) {
    if (split_by_[cell] == kUnsplit) return addLeaf(leaves_[cell], tree);
    const std::uint32_t node = split_by_[cell];
    const auto index = static_cast<std::uint32_t>(tree.nodes.size());
    tree.nodes.push_back({nodes_[node], 0, 0});
    const std::uint32_t below = layOut(2 * node + 1, tree);
    const std::uint32_t above = layOut(2 * node + 2, tree);
    tree.nodes[index].below = below;
    tree.nodes[index].above = above;
    return index;
  }

  std::uint32_t addLeaf(const Leaf& leaf, SearchTree& tree) const {
    const auto index = static_cast<std::uint32_t>(tree.leaves.size());
    tree.depth = std::max(tree.depth, leaf.depth);
    tree.leaves.push_back({static_cast<std::uint32_t>(tree.candidates.size()), leaf.count});
    const auto append = [&leaf](const std::vector<std::uint32_t>& kept, std::vector<std::uint32_t>& to) {
      const auto first = kept.begin() + static_cast<std::ptrdiff_t>(leaf.first);
      to.insert(to.end(), first, first + leaf.count);
    };
    append(candidates_, tree.candidates);
    if (!options_.all_rows) append(tests_, tree.tests);
    return index | MapContent::kLeaf;
  }

  /// The member's rows, which are some of its region's in their order, as bits.
  std::uint32_t testsOf(const CellMember& member) const {
    constexpr std::size_t kLastBit = 31;
    const std::vector<std::int32_t>& all = regions_.rows[member.region];
    std::uint32_t tests = 0;
    std::size_t next = 0;
    for (std::size_t i = 0; i < all.size() && next < member.rows.size(); ++i) {
      if (all[i] != member.rows[next]) continue;
      tests |= std::uint32_t{1} << std::min(i, kLastBit);
      ++next;
    }
    return tests;
  }

  const TreeRegions& regions_;
  const TreeOptions& options_;
  CellSplitter splitter_;
  GrowthLimit limit_;
  Growth now_;
  std::vector<std::unique_ptr<Cell>> cells_;  // empty once split or finished
  std::vector<Leaf> leaves_;                  // of each cell that is finished
  std::vector<std::uint32_t> candidates_, tests_;
  std::vector<std::uint32_t> split_by_;  // node of each cell, or kUnsplit
  std::vector<std::uint32_t> nodes_;     // planes; the children of node i are cells 2 i + 1 and 2 i + 2
  std::priority_queue<Open> open_;
};

}  // namespace

const char* toString(TreeEnd end) {
  switch (end) {
    case TreeEnd::kNoGain:
      return "no split shortens a look-up any more";
    case TreeEnd::kLittleGain:
      return "further nodes gain little";
    case TreeEnd::kNodes:
      return "limit of nodes";
    case TreeEnd::kBytes:
      return "limit of memory";
    case TreeEnd::kMemory:
      return "limit of memory while it grows";
    case TreeEnd::kPivots:
      return "limit of time";
    case TreeEnd::kStopped:
      return "stopped";
  }
  return "unknown";
}

const char* toString(TreeMode mode) {
  switch (mode) {
    case TreeMode::kNone:
      return "none";
    case TreeMode::kFast:
      return "fast";
    case TreeMode::kAuto:
      return "auto";
    case TreeMode::kSmall:
      return "small";
  }
  return "unknown";
}

SearchTree buildTree(const TreeRegions& regions, const TreeOptions& options) {
  return TreeGrower(regions, options).run();
}

}  // namespace polyfly
