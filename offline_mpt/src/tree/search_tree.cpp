#include "offline_mpt/search_tree.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <queue>

#include "support/in_parallel.hpp"
#include "tree/cell_splitter.hpp"

namespace polyfly {
namespace {

// Cells of a batch, which the threads share. It does not depend on their number, nor does the tree.
constexpr std::size_t kBatch = 32;
// A batch takes cells whose look-ups cost at least this share of the worst.
constexpr double kNearWorst = 0.75;
// A cell with more members is split by all threads together.
constexpr std::size_t kLargeCell = 2000;

// Default limits of nodes, per region and at least.
constexpr std::uint64_t kSmallNodes = 64;
constexpr std::uint64_t kOtherNodes = 2;
constexpr std::uint64_t kLeastNodes = 4096;
// kFast: pivots per pivot of the exploration, and at least, which take some 20 ms.
constexpr double kFastPivots = 1.3;
constexpr std::uint64_t kLeastPivots = 40000;
// kAuto: bytes of the tree per byte of the regions, and in any case.
constexpr std::uint64_t kAutoBytes = 3;
constexpr std::uint64_t kFreeBytes = 65536;
// kAuto: the worst case after a doubling of the nodes, relative to the one before, above which more nodes gain little.
constexpr double kLittleGain = 0.85;

// Memory of the parts of all cells, above which a tree of any mode ends [bytes].
constexpr std::uint64_t kMostMemory = std::uint64_t{3} << 29;
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

/// When a tree has grown enough.
class GrowthLimit {
 public:
  GrowthLimit(const TreeRegions& regions, const TreeOptions& options)
      : mode_(options.mode),
        nodes_(options.node_limit),
        pivots_(std::max(kLeastPivots, static_cast<std::uint64_t>(
                                           kFastPivots * static_cast<double>(options.explored_pivots)))),
        bytes_(kFreeBytes + kAutoBytes * bytesOf(regions)) {
    const std::uint64_t per_region = mode_ == TreeMode::kSmall ? kSmallNodes : kOtherNodes;
    if (nodes_ == 0) nodes_ = std::max(kLeastNodes, per_region * regions.rows.size());
    if (mode_ == TreeMode::kNone) nodes_ = 0;
    checked_nodes_ = std::max<std::uint64_t>(kLeastNodes, regions.rows.size() / 4);
  }

  std::uint64_t nodes() const { return nodes_; }

  /// A cell came into memory, or left it.
  void add(const Cell& cell) { memory_ += memoryOf(cell); }
  void remove(const Cell& cell) { memory_ -= memoryOf(cell); }

  /// Which limit a tree has reached whose worst look-up tests `worst` half-spaces.
  std::optional<TreeEnd> reached(std::uint64_t nodes, std::uint64_t pivots, std::uint64_t bytes,
                                 std::uint64_t worst) {
    if (nodes >= nodes_) return TreeEnd::kNodes;
    if (memory_ >= kMostMemory) return TreeEnd::kMemory;
    if (mode_ == TreeMode::kFast && pivots >= pivots_) return TreeEnd::kPivots;
    if (mode_ == TreeMode::kAuto && bytes >= bytes_) return TreeEnd::kBytes;
    if (mode_ == TreeMode::kAuto && gainsLittle(nodes, worst)) return TreeEnd::kLittleGain;
    return std::nullopt;
  }

 private:
  bool gainsLittle(std::uint64_t nodes, std::uint64_t worst) {
    if (nodes < checked_nodes_) return false;
    checked_nodes_ = 2 * nodes;
    const bool gains_little =
        checked_worst_ > 0 && static_cast<double>(worst) > kLittleGain * static_cast<double>(checked_worst_);
    checked_worst_ = worst;
    return gains_little;
  }

  TreeMode mode_;
  std::uint64_t nodes_;
  std::uint64_t pivots_;
  std::uint64_t bytes_;
  std::uint64_t memory_ = 0;
  std::uint64_t checked_nodes_ = 0;  // when the gain is looked at next
  std::uint64_t checked_worst_ = 0;
};

class TreeGrower {
 public:
  TreeGrower(const TreeRegions& regions, const TreeOptions& options)
      : regions_(regions), options_(options), splitter_(regions, options), limit_(regions, options) {}

  SearchTree run() {
    addCell(splitter_.whole(), 0);
    std::optional<TreeEnd> end;
    while (!end) {
      if (open_.empty()) {
        end = TreeEnd::kNoGain;
      } else if (options_.stop != nullptr && options_.stop->load()) {
        end = TreeEnd::kStopped;
      } else {
        end = limit_.reached(nodes_.size(), splitter_.pivots(), bytes_, open_.top().cost);
      }
      if (!end) splitBatch(takeBatch());
      reportProgress();
    }
    finishLeaves();
    SearchTree tree = layOut();
    tree.end = *end;
    return tree;
  }

 private:
  static constexpr std::uint32_t kUnsplit = ~std::uint32_t{0};

  /// A cell that may be split, by the greatest cost of its look-ups.
  struct Open {
    std::uint64_t cost = 0;  // half-spaces
    std::uint32_t cell = 0;

    bool operator<(const Open& other) const {
      return cost != other.cost ? cost < other.cost : cell > other.cell;
    }
  };

  void addCell(Cell cell, std::uint32_t number) {
    const std::uint64_t cost = cell.path.size() + splitter_.tests(cell);
    bytes_ += bytesOf(cell);
    limit_.add(cell);
    cells_.push_back(std::make_unique<Cell>(std::move(cell)));
    split_by_.push_back(kUnsplit);
    if (cells_.back()->members.size() > 1) open_.push({cost, number});
  }

  std::vector<std::uint32_t> takeBatch() {
    std::vector<std::uint32_t> batch;
    const auto least = static_cast<std::uint64_t>(kNearWorst * static_cast<double>(open_.top().cost));
    const std::uint64_t most = std::min<std::uint64_t>(kBatch, limit_.nodes() - nodes_.size());
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
      bytes_ -= bytesOf(*cells_[cell]);
      limit_.remove(*cells_[cell]);
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
        bytes_ += bytesOf(*cells_[batch[i]]);
        limit_.add(*cells_[batch[i]]);
      }
    }
  }

  void addNode(std::uint32_t cell, CellSplit split) {
    const auto node = static_cast<std::uint32_t>(nodes_.size());
    split_by_[cell] = node;
    cells_[cell].reset();
    nodes_.push_back(static_cast<std::uint32_t>(split.plane));
    bytes_ += sizeof(MapContent::Node);
    addCell(std::move(split.below), 2 * node + 1);
    addCell(std::move(split.above), 2 * node + 2);
  }

  void reportProgress() const {
    if (options_.progress)
      options_.progress(std::min<std::uint64_t>(nodes_.size(), limit_.nodes()), limit_.nodes());
  }

  void finishLeaves() {
    inParallel(cells_.size(), options_.threads, nullptr, {}, [&](std::size_t thread, std::uint64_t cell) {
      if (cells_[cell]) splitter_.finishLeaf(*cells_[cell], thread);
    });
  }

  /// Nodes in the order of descents, below first.
  SearchTree layOut() {
    SearchTree tree;
    tree.root = layOut(0, tree);
    return tree;
  }

  std::uint32_t layOut(std::uint32_t cell, SearchTree& tree) {
    if (split_by_[cell] == kUnsplit) return addLeaf(*cells_[cell], tree);
    const std::uint32_t node = split_by_[cell];
    const auto index = static_cast<std::uint32_t>(tree.nodes.size());
    tree.nodes.push_back({nodes_[node], 0, 0});
    const std::uint32_t below = layOut(2 * node + 1, tree);
    const std::uint32_t above = layOut(2 * node + 2, tree);
    tree.nodes[index].below = below;
    tree.nodes[index].above = above;
    return index;
  }

  std::uint32_t addLeaf(const Cell& cell, SearchTree& tree) const {
    const auto index = static_cast<std::uint32_t>(tree.leaves.size());
    tree.depth = std::max(tree.depth, static_cast<std::uint32_t>(cell.path.size()));
    tree.leaves.push_back({static_cast<std::uint32_t>(tree.candidates.size()),
                           static_cast<std::uint32_t>(cell.members.size())});
    for (const CellMember& member : cell.members) {
      tree.candidates.push_back(member.region);
      if (!options_.all_rows) tree.tests.push_back(testsOf(member));
    }
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
  std::uint64_t bytes_ = 0;                   // that the tree takes in a map file
  std::vector<std::unique_ptr<Cell>> cells_;  // empty once split
  std::vector<std::uint32_t> split_by_;       // node of each cell, or kUnsplit
  std::vector<std::uint32_t> nodes_;          // planes; the children of node i are cells 2 i + 1 and 2 i + 2
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
