#include "region_cover.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include "cone.hpp"
#include "region_maps/region_map.hpp"
#include "support/in_parallel.hpp"

namespace polyfly {
namespace {

// Nodes of this depth lead to the parts that threads share.
constexpr int kTaskDepth = 6;

using Cell = DoubleDescription;
using IntegerRow = std::vector<Integer>;
using Regions = std::vector<std::uint32_t>;

/// A part of the set below a node of the tree, and what came of it.
struct Task {
  std::uint32_t child = 0;
  Cell cell;
  SetCover cover;
};

IntegerRow opposite(IntegerRow row) {
  for (Integer& value : row) value = -value;
  return row;
}

/// Whether the cell has a vertex strictly outside of a row.
bool reachesOut(const Cell& cell, const IntegerRow& row) {
  return std::any_of(cell.rays().begin(), cell.rays().end(),
                     [&](const Cell::Ray& ray) { return dot(row, ray.value) < 0; });
}

/// A point inside: the mean of the vertices, with weights of 1 to 2.
IntegerRow middleOf(const Cell& cell) {
  const auto bits = [](const Cell::Ray& ray) { return mpz_sizeinbase(ray.value[0].get_mpz_t(), 2); };
  std::size_t most = 0;
  for (const Cell::Ray& ray : cell.rays()) most = std::max(most, bits(ray));
  IntegerRow sum(cell.rays().front().value.size());
  for (const Cell::Ray& ray : cell.rays()) {
    for (std::size_t j = 0; j < sum.size(); ++j) sum[j] += ray.value[j] << (most - bits(ray));
  }
  return sum;
}

class CoverSearch {
 public:
  explicit CoverSearch(const MapRegions& regions) : regions_(regions), all_(regions.count()) {
    std::iota(all_.begin(), all_.end(), 0U);
  }

  /// Divides the cell among the nodes of kTaskDepth and leaves above.
  void divide(std::uint32_t child, const Cell& cell, int depth, std::vector<Task>& tasks) const {
    if (depth == kTaskDepth || (child & MapContent::kLeaf) != 0) {
      tasks.push_back({child, cell, {}});
      return;
    }
    forEachSide(child, cell, [&](std::uint32_t next, const Cell& part) {
      divide(next, part, depth + 1, tasks);
      return true;
    });
  }

  bool cover(std::uint32_t child, const Cell& cell, SetCover& found) const {
    if ((child & MapContent::kLeaf) == 0) {
      return forEachSide(child, cell,
                         [&](std::uint32_t next, const Cell& part) { return cover(next, part, found); });
    }
    const LeafView leaf = regions_.map().leaf(child & ~MapContent::kLeaf);
    return coverBy(cell, {leaf.candidates, leaf.candidates + leaf.count}, false, found);
  }

 private:
  /// Calls `visit` with the node's children and what the cell has there. A cell on the plane belongs to the first one.
  template <typename Visit>
  bool forEachSide(std::uint32_t child, const Cell& cell, const Visit& visit) const {
    const MapContent::Node& node = regions_.map().node(child);
    const auto row = static_cast<std::int32_t>(node.plane) + 1;
    const IntegerRow &below = regions_.inside(row, false), &above = regions_.inside(-row, false);
    const bool reaches_above = reachesOut(cell, below), reaches_below = reachesOut(cell, above);
    if (!reaches_above) return visit(node.below, cell);
    return (!reaches_below || visit(node.below, cut(cell, below))) &&
           visit(node.above, reaches_below ? cut(cell, above) : cell);
  }

  static Cell cut(Cell cell, const IntegerRow& row) {
    cell.add(row);
    return cell;
  }

  /// The region that holds the cell's middle is cut away; first as it is, then moved outwards. A region that was cut away as it
  /// is cannot hold the middle of what is left, and one that was moved is not in `left` any more.
  bool coverBy(const Cell& cell, Regions left, bool is_all, SetCover& found) const {
    const IntegerRow middle = middleOf(cell);
    for (const bool moved : {false, true}) {
      const auto holder = std::find_if(left.begin(), left.end(), [&](std::uint32_t region) {
        return regions_.holds(region, middle, moved);
      });
      if (holder == left.end()) continue;
      const std::uint32_t region = *holder;
      if (moved) left.erase(holder);
      return cutAway(region, moved, cell, left, is_all, found);
    }
    if (!is_all) return coverBy(cell, all_, true, found);
    found.gap = pointOf(middle);
    return false;
  }

  bool cutAway(std::uint32_t region, bool moved, Cell cell, const Regions& left, bool is_all,
               SetCover& found) const {
    const RegionView view = regions_.map().region(region);
    for (std::uint32_t i = 0; i < view.row_count; ++i) {
      const IntegerRow& inside = regions_.inside(view.rows[i], moved);
      if (!reachesOut(cell, inside)) continue;
      if (!coverBy(cut(cell, opposite(inside)), left, is_all, found)) return false;
      cell.add(inside);
    }
    if (moved) found.slivers.push_back({region, raysOf(cell)});
    return true;
  }

  const MapRegions& regions_;
  Regions all_;
};

}  // namespace

// Tasks are in the order of the tree, and so is what is found, up to the first gap.
SetCover coverSet(const MapRegions& regions, const ExactPolytope& set, int threads,
                  const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  SetCover result;
  const PolytopeCone polytope(set);
  if (polytope.isEmpty()) return result;
  const CoverSearch search(regions);
  std::vector<Task> tasks;
  search.divide(regions.map().root(), polytope.cone, 0, tasks);
  const auto work = [&](std::size_t, std::uint64_t i) {
    tasks[i].cover.covered = search.cover(tasks[i].child, tasks[i].cell, tasks[i].cover);
  };
  inParallel(tasks.size(), threads, nullptr, progress, work);
  for (Task& task : tasks) {
    if (!result.covered) continue;
    std::move(task.cover.slivers.begin(), task.cover.slivers.end(), std::back_inserter(result.slivers));
    result.covered = task.cover.covered;
    result.gap = std::move(task.cover.gap);
  }
  return result;
}

}  // namespace polyfly
