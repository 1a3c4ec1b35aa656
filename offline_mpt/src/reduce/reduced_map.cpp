#include "reduce/reduced_map.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "offline_mpt/search_tree.hpp"
#include "reduce/law_leaves.hpp"
#include "reduce/prune_tree.hpp"
#include "reduce/tolerances.hpp"
#include "region_maps/region_map.hpp"
#include "tree/row_order.hpp"

namespace polyfly {
namespace {

// Of kAuto.
constexpr std::size_t kNodesPerRegion = 2;

/// What look-ups read of planes and nodes.
std::size_t bytesRead(const SearchTree& tree, const TreeRegions& regions) {
  const std::size_t plane_bytes = sizeof(double) * (static_cast<std::size_t>(regions.p) + 1);
  std::set<std::size_t> planes;
  for (const MapContent::Node& node : tree.nodes) planes.insert(node.plane);
  for (std::size_t k = 0; k < tree.candidates.size(); ++k) {
    const RowList& rows = regions.rows[tree.candidates[k]];
    for (std::uint32_t row = 0; row < rows.size(); ++row) {
      if (isTested(tree.tests[k], row)) planes.insert(static_cast<std::size_t>(std::abs(rows[row])) - 1);
    }
  }
  return plane_bytes * planes.size() + sizeof(MapContent::Node) * tree.nodes.size();
}

class Encoder {
 public:
  Encoder(const RegionMap& map, const ScaledPlanes& planes, ReducedRegions reduced,
          const ReduceOptions& options)
      : map_(map),
        planes_(planes),
        reduced_(std::move(reduced)),
        options_(options),
        entries_(reduced_.regions) {}

  MapContent run() {
    MapContent content;
    content.name = map_.name();
    content.problem_text = map_.problemText();
    content.problem_kind = map_.problemKind();
    content.solver_status = map_.solverStatus();
    content.period = map_.period();
    content.tolerance = map_.tolerance();
    content.parameters = map_.parameters();
    content.inputs = map_.inputs();
    content.reduced_from = map_.checksum();
    SearchTree tree = findTree();
    content.solver_notes = "tree_depth: " + std::to_string(tree.depth) + "\n";
    moveTree(std::move(tree), content);
    addPlanes(content);
    addRegions(content);
    orderRows(content);
    return content;
  }

 private:
  /// Nodes name planes by their number in `planes_`. Of kSmall, regions may be added or left out.
  SearchTree findTree() {
    TreeRegions regions;
    regions.p = planes_.p;
    regions.planes = planes_.planes;
    std::vector<std::uint32_t> laws;
    for (const ReducedRegion& entry : entries_) {
      regions.rows.push_back(entry.piece.rows);
      regions.centres.insert(regions.centres.end(), entry.piece.centre.begin(), entry.piece.centre.end());
      laws.push_back(entry.law);
    }
    TreeOptions options;
    options.mode = options_.tree;
    options.threads = options_.threads;
    options.side_tolerance = options_.side_tolerance;
    options.stop = options_.stop;
    options.progress = options_.tree_progress;
    if (options.mode != TreeMode::kSmall) {
      options.all_rows = true;
      options.node_limit = kNodesPerRegion * regions.rows.size();
    }
    CellGeometry geometry(planes_, options_.stop);
    if (options.mode != TreeMode::kSmall)
      return pruneTree(geometry, regions, laws, reduced_.slack, options.side_tolerance,
                       wholeTree(regions, options));
    options.least_angle = tolerance::kCellAngle;
    GrownTree best = growTree(geometry, regions, laws, options);
    TreeRegions with_laws = regions;
    with_laws.laws = laws;
    GrownTree other = growTree(geometry, with_laws, laws, options);
    if (other.cost < best.cost) best = std::move(other);
    for (LawCell& cell : best.cells) entries_.push_back({std::move(cell.piece), cell.law, -1});
    dropUnusedRegions(best.tree);
    return std::move(best.tree);
  }

  static SearchTree wholeTree(const TreeRegions& regions, const TreeOptions& options) {
    SearchTree tree = buildTree(regions, options);
    const bool is_stopped =
        options.stop != nullptr && options.stop->load();  // after the first of several trees
    if (tree.end == TreeEnd::kStopped || is_stopped) throw ReductionStopped();
    return tree;
  }

  /// A tree, with the regions that its leaves add.
  struct GrownTree {
    SearchTree tree;
    std::vector<LawCell> cells;
    /// Half-spaces of the worst look-up, then the bytes that look-ups read of planes and nodes.
    std::pair<std::uint64_t, std::size_t> cost;
  };

  GrownTree growTree(CellGeometry& geometry, TreeRegions regions, std::vector<std::uint32_t> laws,
                     const TreeOptions& options) const {
    GrownTree result;
    const SearchTree grown = wholeTree(regions, options);
    result.tree = joinByLaw(geometry, regions, laws, reduced_.box, reduced_.slack, grown, result.cells);
    for (const LawCell& cell : result.cells) {
      regions.rows.push_back(cell.piece.rows);
      regions.centres.insert(regions.centres.end(), cell.piece.centre.begin(), cell.piece.centre.end());
      laws.push_back(cell.law);
    }
    result.tree = pruneTree(geometry, regions, laws, reduced_.slack, options.side_tolerance, result.tree);
    result.cost = {result.tree.worst, bytesRead(result.tree, regions)};
    return result;
  }

  /// Leaves out the regions that no leaf names.
  void dropUnusedRegions(SearchTree& tree) {
    constexpr std::uint32_t kUnused = ~std::uint32_t{0};
    std::vector<std::uint32_t> number(entries_.size(), kUnused);
    for (const std::uint32_t region : tree.candidates) number[region] = 0;
    std::uint32_t kept = 0;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      if (number[i] == kUnused) continue;
      number[i] = kept;
      if (kept != i) entries_[kept] = std::move(entries_[i]);
      ++kept;
    }
    entries_.resize(kept);
    for (std::uint32_t& region : tree.candidates) region = number[region];
  }

  /// Only planes that are still used; nodes and rows are renumbered.
  void addPlanes(MapContent& content) {
    const auto p = static_cast<std::size_t>(planes_.p);
    std::vector<std::int32_t> number(planes_.planes.size() / (p + 1), 0);
    for (const ReducedRegion& entry : entries_) {
      for (const std::int32_t row : entry.piece.rows) number[static_cast<std::size_t>(std::abs(row)) - 1] = 1;
    }
    for (const MapContent::Node& node : content.nodes) number[node.plane] = 1;
    std::int32_t next = 0;
    for (std::size_t i = 0; i < number.size(); ++i) {
      if (number[i] == 0) continue;
      number[i] = ++next;
      const double* const scaled = planes_.planes.data() + i * (p + 1);
      if (i < map_.planeCount()) {
        content.planes.insert(content.planes.end(), map_.plane(i), map_.plane(i) + p + 1);
        continue;
      }
      double bound = scaled[p];
      for (std::size_t j = 0; j < p; ++j) {
        const Signal& signal = map_.parameters()[j];
        const double a = scaled[j] / (0.5 * (signal.upper - signal.lower));
        content.planes.push_back(a);
        bound += a * 0.5 * (signal.upper + signal.lower);
      }
      content.planes.push_back(bound);
    }
    for (MapContent::Node& node : content.nodes)
      node.plane = static_cast<std::uint32_t>(number[node.plane] - 1);
    for (ReducedRegion& entry : entries_) {
      for (std::int32_t& row : entry.piece.rows) {
        const std::int32_t plane = number[static_cast<std::size_t>(std::abs(row)) - 1];
        row = row > 0 ? plane : -plane;
      }
    }
  }

  void addRegions(MapContent& content) {
    const std::size_t width = map_.inputs().size() * (map_.parameters().size() + 1);
    std::map<std::uint32_t, std::uint32_t> laws;
    for (const ReducedRegion& entry : entries_) laws.emplace(entry.law, 0);
    std::uint32_t next = 0;
    for (auto& [law, number] : laws) {
      number = next++;
      content.laws.insert(content.laws.end(), map_.law(law), map_.law(law) + width);
    }
    for (const ReducedRegion& entry : entries_) {
      MapContent::Region region;
      region.first_row = static_cast<std::uint32_t>(content.rows.size());
      region.row_count = static_cast<std::uint32_t>(entry.piece.rows.size());
      region.law = laws[entry.law];
      region.first_active = static_cast<std::uint32_t>(content.active.size());
      if (entry.source >= 0) {
        const RegionView source = map_.region(static_cast<std::size_t>(entry.source));
        region.active_count = source.active_count;
        content.active.insert(content.active.end(), source.active, source.active + source.active_count);
      }
      content.rows.insert(content.rows.end(), entry.piece.rows.begin(), entry.piece.rows.end());
      content.regions.push_back(region);
    }
  }

  const RegionMap& map_;
  const ScaledPlanes& planes_;
  ReducedRegions reduced_;
  const ReduceOptions& options_;
  std::vector<ReducedRegion>& entries_;
};

}  // namespace

MapContent encodeReduced(const RegionMap& original, const ScaledPlanes& planes, ReducedRegions reduced,
                         const ReduceOptions& options) {
  return Encoder(original, planes, std::move(reduced), options).run();
}

}  // namespace polyfly
