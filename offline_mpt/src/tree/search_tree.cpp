#include "offline_mpt/search_tree.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "support/in_parallel.hpp"
#include "tree/tree_cells.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kLarge = 1500;           // regions above which a tree is built more cheaply
constexpr std::size_t kManyMembers = 200;      // members above which estimates are trusted
constexpr std::size_t kMembersScored = 8192;   // that planes are scored by, evenly drawn from more
constexpr std::size_t kPlanesTried = 64;       // planes tried before regions count as inseparable
constexpr std::size_t kEntangled = 24;         // members above which a cell is split in any case
constexpr double kLateDepth = 4.0;             // beyond that of a balanced tree
constexpr double kRepeated = 1.6;              // members on both sides together, relative to those before
constexpr std::uint64_t kNodesPerRegion = 64;  // the default budget, but not more than kNodes,
constexpr std::uint64_t kNodes = 131072;       // which take a minute or two,
constexpr std::uint64_t kLeastPerRegion = 2;   // and not less than so many per region
constexpr double kFewNodes = 3.0;              // interior nodes per region that buy smaller leaves, with
constexpr int kFineLeafRegions = 2;            // so many regions,
constexpr int kFineLawRows = 20;               // or half-spaces of one law
constexpr std::size_t kTasks = 32;  // a cell with one in so many of all regions is a task of its own
constexpr std::uint32_t kPending = 1u << 30;  // marks the number of a task in place of a node's

/// What a plane would leave on its sides.
struct Estimate {
  std::size_t plane = 0;
  std::size_t below = 0;
  std::size_t above = 0;

  std::size_t fuller() const { return std::max(below, above); }
  std::size_t total() const { return below + above; }
};

bool better(const Estimate& a, const Estimate& b) {
  if (a.fuller() != b.fuller()) return a.fuller() < b.fuller();
  if (a.total() != b.total()) return a.total() < b.total();
  return a.plane < b.plane;
}

/// The options with all that they leave open decided.
TreeOptions decided(TreeOptions options, std::size_t regions) {
  const bool large = regions > kLarge;
  if (options.leaf_regions > 0 || options.law_rows > 0) options.fine_nodes = 0.0;
  if (options.fine_nodes < 0.0) options.fine_nodes = kFewNodes * static_cast<double>(regions);
  if (options.leaf_regions <= 0) options.leaf_regions = large ? 6 : 5;
  if (options.law_rows <= 0) options.law_rows = large ? 80 : 40;
  if (options.planes_tried <= 0) options.planes_tried = large ? 3 : 6;
  if (options.node_limit == 0) {
    options.node_limit = std::max(std::min(kNodesPerRegion * regions, kNodes), kLeastPerRegion * regions);
  }
  return options;
}

/// Interior nodes of a cell, its own and those below it: each side has its share by its members.
struct Budget {
  double all = 0.0;   ///< that there may be
  double fine = 0.0;  ///< as long as there are some, leaves are made smaller

  Budget side(double share) const { return {share * (all - 1.0), share * (fine - 1.0)}; }
};

/// A cell whose subtree is built apart from the rest.
struct Task {
  CellMembers members;
  std::vector<std::int32_t> path;
  Budget budget;
};

/// Grows a tree, or the subtree of a cell.
class TreeGrower {
 public:
  TreeGrower(const TreeGeometry& geometry, const TreeOptions& options)
      : geometry_(geometry),
        options_(options),
        balanced_depth_(std::log2(static_cast<double>(geometry.regions().rows.size()))),
        splitter_(geometry) {}

  /// Cells with at most `size` members are put off, to be grown apart.
  void defer(std::size_t size, std::vector<Task>& tasks) {
    task_size_ = size;
    tasks_ = &tasks;
  }

  SearchTree run(Task task) {
    tree_ = {};
    path_ = std::move(task.path);
    tree_.root = grow(std::move(task.members), task.budget);
    return std::move(tree_);
  }

 private:
  std::uint32_t grow(CellMembers members, Budget budget) {
    if (tasks_ != nullptr && members.size() <= task_size_) {
      tasks_->push_back({std::move(members), path_, budget});
      return kPending | static_cast<std::uint32_t>(tasks_->size() - 1);
    }
    tree_.depth = std::max(tree_.depth, static_cast<std::uint32_t>(path_.size()));
    CellMembers below, above;
    std::size_t plane = 0;
    if (isSmall(members, budget.fine >= 1.0) || budget.all < 1.0 || stopped() ||
        !choose(members, plane, below, above)) {
      return leaf(members);
    }
    CellMembers().swap(members);
    const auto index = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes.push_back({static_cast<std::uint32_t>(plane), 0, 0});
    const double share = static_cast<double>(below.size()) / static_cast<double>(below.size() + above.size());
    path_.push_back(static_cast<std::int32_t>(plane) + 1);
    const std::uint32_t first = grow(std::move(below), budget.side(share));
    path_.back() = -path_.back();
    const std::uint32_t second = grow(std::move(above), budget.side(1.0 - share));
    path_.pop_back();
    tree_.nodes[index].below = first;
    tree_.nodes[index].above = second;
    return index;
  }

  bool stopped() const { return options_.stop != nullptr && options_.stop->load(); }

  std::uint32_t leaf(const CellMembers& members) {
    const auto index = static_cast<std::uint32_t>(tree_.leaves.size());
    tree_.leaves.push_back(
        {static_cast<std::uint32_t>(tree_.candidates.size()), static_cast<std::uint32_t>(members.size())});
    for (const CellMember& member : members) tree_.candidates.push_back(member.region);
    return index | MapContent::kLeaf;
  }

  bool isSmall(const CellMembers& members, bool fine) const {
    const int most = fine ? std::min(kFineLeafRegions, options_.leaf_regions) : options_.leaf_regions;
    return members.size() <= static_cast<std::size_t>(most) ||
           oneLaw(members, fine ? std::min(kFineLawRows, options_.law_rows) : options_.law_rows);
  }

  bool oneLaw(const CellMembers& members, int most_rows) const {
    const TreeRegions& regions = geometry_.regions();
    if (regions.laws.empty()) return false;
    std::size_t rows = 0;
    for (const CellMember& member : members) {
      rows += regions.rows[member.region].size();
      if (rows > static_cast<std::size_t>(most_rows)) return false;
      if (regions.laws[member.region] != regions.laws[members.front().region]) return false;
    }
    return true;
  }

  /// Regions that no plane keeps apart: slivers along a common edge, which splitting only repeats on both
  /// sides. Only below the depth at which a balanced tree would have ended.
  bool unsplittable(const Estimate& split, std::size_t members) const {
    return static_cast<double>(path_.size()) > balanced_depth_ + kLateDepth && members <= kEntangled &&
           static_cast<double>(split.total()) > kRepeated * static_cast<double>(members);
  }

  // The best of the planes that bound members, by exact splits of those that look best.
  bool choose(CellMembers& members, std::size_t& plane, CellMembers& below, CellMembers& above) {
    std::vector<Estimate> estimates = estimate(members);
    std::sort(estimates.begin(), estimates.end(), better);
    const std::size_t tried =
        members.size() > kManyMembers ? 1 : static_cast<std::size_t>(options_.planes_tried);
    std::vector<unsigned char> sides, best_sides;
    Estimate best;
    bool found = false;
    for (std::size_t i = 0; i < estimates.size() && i < kPlanesTried; ++i) {
      if (i >= tried && found) break;
      if (found && estimates[i].fuller() > best.fuller()) break;
      const Estimate exact = splitExactly(members, estimates[i].plane, sides);
      if (exact.fuller() >= members.size()) continue;
      if (!found || better(exact, best)) {
        best = exact;
        best_sides = sides;
        found = true;
      }
    }
    if (!found || unsplittable(best, members.size())) return false;
    plane = best.plane;
    splitter_.divide(members, plane, path_, best_sides, below, above);
    return true;
  }

  std::vector<Estimate> estimate(const CellMembers& members) const {
    const std::vector<std::size_t> planes = planesOf(members);
    const std::size_t stride = planes.size() / static_cast<std::size_t>(options_.planes_scored) + 1;
    const std::size_t step = members.size() / kMembersScored + 1;
    std::vector<Estimate> estimates;
    for (std::size_t i = 0; i < planes.size(); i += stride) estimates.push_back({planes[i]});
    for (std::size_t m = 0; m < members.size(); m += step) {  // all planes stay in the cache, members do not
      for (Estimate& entry : estimates) {
        const unsigned sides = geometry_.seenSides(members[m], entry.plane);
        if (sides & kBelow) ++entry.below;
        if (sides & kAbove) ++entry.above;
      }
    }
    return estimates;
  }

  // Those that bound members, but not the cell.
  std::vector<std::size_t> planesOf(const CellMembers& members) const {
    std::vector<std::size_t> planes;
    for (const CellMember& member : members) {
      for (const std::int32_t row : geometry_.regions().rows[member.region]) {
        planes.push_back(TreeGeometry::planeOf(row));
      }
    }
    std::sort(planes.begin(), planes.end());
    planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
    const auto on_path = [&](std::size_t plane) {
      return std::any_of(path_.begin(), path_.end(),
                         [&](std::int32_t row) { return TreeGeometry::planeOf(row) == plane; });
    };
    planes.erase(std::remove_if(planes.begin(), planes.end(), on_path), planes.end());
    return planes;
  }

  Estimate splitExactly(CellMembers& members, std::size_t plane, std::vector<unsigned char>& sides) {
    Estimate result;
    result.plane = plane;
    sides.assign(members.size(), 0);
    for (std::size_t i = 0; i < members.size(); ++i) {
      const unsigned reached = splitter_.sides(members[i], plane, path_);
      sides[i] = static_cast<unsigned char>(reached);
      if (reached & kBelow) ++result.below;
      if (reached & kAbove) ++result.above;
    }
    return result;
  }

  const TreeGeometry& geometry_;
  const TreeOptions& options_;
  double balanced_depth_;
  CellSplitter splitter_;
  std::size_t task_size_ = 0;
  std::vector<Task>* tasks_ = nullptr;
  std::vector<std::int32_t> path_;
  SearchTree tree_;
};

/// Looking at the regions is the first half of the work, growing the tree over them the second: 0 .. 2.
void report(const TreeOptions& options, std::size_t regions, double halves) {
  if (!options.progress) return;
  const auto count = static_cast<double>(regions);
  options.progress(static_cast<std::uint64_t>(halves * count), 2 * regions);
}

/// The subtrees of all tasks, by whichever thread is free.
std::vector<SearchTree> growAll(const TreeGeometry& geometry, const TreeOptions& options,
                                std::vector<Task>& tasks) {
  std::vector<SearchTree> trees(tasks.size());
  std::atomic<std::uint64_t> done{0};
  std::uint64_t total = 0;
  for (const Task& task : tasks) total += task.members.size();
  std::vector<TreeGrower> growers;
  for (int k = 0; k < std::max(1, options.threads); ++k) growers.emplace_back(geometry, options);
  const auto progress = [&](std::uint64_t, std::uint64_t) {
    const auto share = static_cast<double>(done) / static_cast<double>(total);
    report(options, geometry.regions().rows.size(), 1.0 + share);
  };
  inParallel(tasks.size(), options.threads, nullptr, progress, [&](std::size_t thread, std::uint64_t i) {
    const std::size_t size = tasks[i].members.size();
    trees[i] = growers[thread].run(std::move(tasks[i]));
    done += size;
  });
  return trees;
}

/// Adds a subtree; its root's place in the whole tree.
std::uint32_t append(const SearchTree& part, SearchTree& whole) {
  const auto nodes = static_cast<std::uint32_t>(whole.nodes.size());
  const auto leaves = static_cast<std::uint32_t>(whole.leaves.size());
  const auto candidates = static_cast<std::uint32_t>(whole.candidates.size());
  const auto moved = [&](std::uint32_t child) {
    return (child & MapContent::kLeaf) != 0 ? ((child & ~MapContent::kLeaf) + leaves) | MapContent::kLeaf
                                            : child + nodes;
  };
  for (const MapContent::Node& node : part.nodes) {
    whole.nodes.push_back({node.plane, moved(node.below), moved(node.above)});
  }
  for (const MapContent::Leaf& leaf : part.leaves)
    whole.leaves.push_back({leaf.first + candidates, leaf.count});
  whole.candidates.insert(whole.candidates.end(), part.candidates.begin(), part.candidates.end());
  whole.depth = std::max(whole.depth, part.depth);
  return moved(part.root);
}

void join(const std::vector<SearchTree>& parts, SearchTree& tree) {
  const std::size_t top = tree.nodes.size();
  std::vector<std::uint32_t> roots;
  for (const SearchTree& part : parts) roots.push_back(append(part, tree));
  const auto settle = [&](std::uint32_t& child) {
    if ((child & MapContent::kLeaf) == 0 && (child & kPending) != 0) child = roots[child & ~kPending];
  };
  settle(tree.root);
  for (std::size_t i = 0; i < top; ++i) {
    settle(tree.nodes[i].below);
    settle(tree.nodes[i].above);
  }
}

}  // namespace

SearchTree buildTree(const TreeRegions& regions, const TreeOptions& options) {
  const TreeOptions choices = decided(options, regions.rows.size());
  const auto sampled = [&](std::uint64_t done, std::uint64_t total) {
    report(choices, regions.rows.size(), static_cast<double>(done) / static_cast<double>(total));
  };
  TreeGeometry geometry(regions, choices.side_tolerance, choices.threads, sampled);
  std::vector<Task> tasks;
  TreeGrower top(geometry, choices);
  const std::size_t size = std::max(kManyMembers, regions.rows.size() / kTasks);
  top.defer(size, tasks);
  SearchTree tree =
      top.run({geometry.takeMembers(), {}, {static_cast<double>(choices.node_limit), choices.fine_nodes}});
  join(growAll(geometry, choices, tasks), tree);
  return tree;
}

}  // namespace polyfly
