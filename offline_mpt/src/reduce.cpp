#include "offline_mpt/reduce.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <numeric>
#include <vector>

#include "in_parallel.hpp"
#include "law_classes.hpp"
#include "merge.hpp"
#include "offline_mpt/partition.hpp"
#include "offline_mpt/search_tree.hpp"
#include "prune_tree.hpp"
#include "region_maps/error.hpp"
#include "separate.hpp"

namespace polyfly {
namespace {

constexpr double kSlackShare =
    0.125;                          // of the map's tolerance: how far regions may be off when they are joined
constexpr double kThin = 1e-11;     // regions with a smaller inscribed ball are left as they are [scaled]
constexpr double kConstant = 1e-6;  // greatest change of a constant input over the box, relative as laws
// A sliver that the tree leaves to a neighbour must not be left to a fallback region, whose law may be
// another.
constexpr double kSharpSide = 0.1;
constexpr std::size_t kMostFallbacks = 64;

/// A region of the reduced map.
struct Entry {
  Piece piece;
  std::uint32_t law = 0;
  int source = -1;  // the region that it is, unchanged; -1: a union
};

/// Regions of the map with the same law.
struct LawGroup {
  std::uint32_t law = 0;
  std::vector<std::uint32_t> regions;  // with interiors
  std::vector<double> foreign;         // centres of all regions with other laws
  Merged merged;
};

class Reducer {
 public:
  Reducer(const RegionMap& map, const ReduceOptions& options)
      : map_(map),
        options_(options),
        slack_(kSlackShare * map.tolerance()),
        planes_(ScaledPlanes::of(map)),
        box_(planes_.addBox()) {
    stats_.merge = options.merge;
  }

  ReduceResult run() {
    describeRegions();
    groupByLaw();
    mergeAll();
    if (options_.separate) separateSaturated();
    collect();
    ReduceResult result;
    result.content = encode();
    result.stats = stats_;
    return result;
  }

 private:
  void describeRegions() {
    PieceGeometry geometry(planes_);
    for (std::size_t r = 0; r < map_.regionCount(); ++r) {
      const RegionView region = map_.region(r);
      Piece piece;
      piece.rows.assign(region.rows, region.rows + region.row_count);
      geometry.describe(piece);
      pieces_.push_back(std::move(piece));
    }
  }

  void groupByLaw() {
    class_of_ = lawClasses(map_, options_.law_tolerance);
    std::map<std::uint32_t, std::size_t> number;
    for (std::uint32_t r = 0; r < pieces_.size(); ++r) {
      const std::uint32_t law = class_of_[map_.region(r).law];
      const auto [found, is_new] = number.emplace(law, groups_.size());
      if (is_new) groups_.push_back({law, {}, {}, {}});
      if (pieces_[r].radius > kThin) groups_[found->second].regions.push_back(r);
    }
    for (LawGroup& group : groups_) {
      if (group.regions.size() < 2) continue;
      for (std::uint32_t r = 0; r < pieces_.size(); ++r) {
        if (class_of_[map_.region(r).law] == group.law) continue;
        group.foreign.insert(group.foreign.end(), pieces_[r].centre.begin(), pieces_[r].centre.end());
      }
    }
    stats_.laws = groups_.size();
  }

  void mergeAll() {
    const auto threads = static_cast<std::size_t>(std::clamp(options_.threads, 1, 256));
    std::vector<std::unique_ptr<PieceGeometry>> geometries;
    for (std::size_t i = 0; i < threads; ++i) geometries.push_back(std::make_unique<PieceGeometry>(planes_));
    const bool finished = inParallel(groups_.size(), static_cast<int>(threads), options_.stop,
                                     options_.progress, [&](std::size_t thread, std::uint64_t i) {
                                       groups_[i].merged = merge(*geometries[thread], groups_[i]);
                                     });
    if (!finished) throw Error(map_.path() + ": reduce: interrupted, nothing was kept");
    for (const LawGroup& group : groups_) {
      if (group.merged.pieces.size() < group.regions.size()) ++stats_.merged_laws;
      if (options_.merge != MergeMethod::kNone)
        ++(group.merged.optimal ? stats_.optimal_laws : stats_.greedy_laws);
    }
  }

  Merged merge(PieceGeometry& geometry, const LawGroup& group) const {
    MergeTask task;
    for (const std::uint32_t r : group.regions) task.pieces.push_back(pieces_[r]);
    task.foreign = &group.foreign;
    task.box = box_;
    task.slack = slack_;
    MergeLimits limits;
    switch (options_.merge) {
      case MergeMethod::kNone:
        break;
      case MergeMethod::kGreedy:
        return mergeGreedily(geometry, task);
      case MergeMethod::kOptimal:
        limits.planes = kOptimalPlanes;
        limits.cells = kOptimalCells;
        return mergeOptimally(geometry, task, limits);
      case MergeMethod::kAuto:
        limits.planes = kAutoPlanes;
        limits.cells = kAutoCells;
        return mergeOptimally(geometry, task, limits);
    }
    return {task.pieces, task.pieces.size() < 2};
  }

  /// The constant law with the greatest or the least input; null if there is none at the input's bound.
  LawGroup* saturatedGroup(bool upper) {
    LawGroup* best = nullptr;
    double best_value = 0.0;
    const std::size_t p = map_.parameters().size();
    for (LawGroup& group : groups_) {
      if (!isConstantLaw(map_, group.law, kConstant)) continue;
      const double value = map_.law(group.law)[p];
      if (best != nullptr && (upper ? value <= best_value : value >= best_value)) continue;
      best = &group;
      best_value = value;
    }
    if (best == nullptr) return nullptr;
    const Signal& input = map_.inputs().front();
    const double bound = upper ? input.upper : input.lower;
    const double scale = lawScales(map_).front();
    if (std::isfinite(bound) && std::abs(best_value - bound) > kConstant * scale) return nullptr;
    return best;
  }

  std::vector<Piece> piecesOf(const LawGroup* group) const {
    std::vector<Piece> result;
    if (group == nullptr) return result;
    for (const std::uint32_t r : group->regions) result.push_back(pieces_[r]);
    return result;
  }

  void separateSaturated() {
    LawGroup* upper = saturatedGroup(true);
    LawGroup* lower = saturatedGroup(false);
    if (upper == lower) lower = nullptr;  // one constant law: of either kind
    const std::size_t regions = (upper != nullptr ? upper->merged.pieces.size() : 0) +
                                (lower != nullptr ? lower->merged.pieces.size() : 0);
    if (regions == 0) {
      stats_.separation = "no law is constant at a bound of the input";
      return;
    }
    const std::size_t kinds = (upper != nullptr ? 1 : 0) + (lower != nullptr ? 1 : 0);
    if (regions <= kinds) {
      stats_.separation = std::to_string(regions) + " saturated regions stay: as few as can be";
      return;
    }
    PieceGeometry geometry(planes_);
    const Piece domain = domainOf(geometry, pieces_, box_, slack_);
    const std::size_t limit = std::min(kMostFallbacks, regions - 1);
    const Separation separation =
        separate(geometry, planes_, domain, piecesOf(upper), piecesOf(lower), limit);
    if (!separation.done) {
      stats_.separation = std::to_string(regions) + " saturated regions stay: no " +
                          (limit > 1 ? std::to_string(limit - 1) + " planes separate" : "plane separates") +
                          " them";
      return;
    }
    if (separation.fallbacks.size() >= regions) {
      stats_.separation = std::to_string(regions) + " saturated regions stay: as many would take their place";
      return;
    }
    for (const Fallback& part : separation.fallbacks)
      fallbacks_.push_back({part.piece, (part.upper ? upper : lower)->law, -1});
    for (LawGroup* group : {upper, lower}) {
      if (group == nullptr) continue;
      stats_.saturated_regions += group->regions.size();
      group->merged.pieces.clear();
      replaced_.push_back(group->law);
    }
    stats_.separated = true;
    stats_.fallback_regions = fallbacks_.size();
    stats_.separating_planes = separation.planes;
    stats_.separation = std::to_string(stats_.saturated_regions) + " saturated regions gave way to " +
                        std::to_string(fallbacks_.size()) + " fallback regions, with " +
                        std::to_string(separation.planes) + " planes between them";
  }

  void collect() {
    for (const LawGroup& group : groups_) {
      for (const Piece& piece : group.merged.pieces)
        entries_.push_back({piece, group.law, sourceOf(group, piece)});
    }
    // Regions too thin to be joined stay as they are.
    for (std::uint32_t r = 0; r < pieces_.size(); ++r) {
      const std::uint32_t law = class_of_[map_.region(r).law];
      if (pieces_[r].radius > kThin || std::find(replaced_.begin(), replaced_.end(), law) != replaced_.end())
        continue;
      entries_.push_back({pieces_[r], law, static_cast<int>(r)});
    }
    first_fallback_ = fallbacks_.empty() ? 0 : entries_.size();
    for (Entry& entry : fallbacks_) entries_.push_back(std::move(entry));
  }

  /// The region of the map that has exactly these rows.
  int sourceOf(const LawGroup& group, const Piece& piece) const {
    RowList wanted = piece.rows;
    std::sort(wanted.begin(), wanted.end());
    for (const std::uint32_t r : group.regions) {
      RowList rows = pieces_[r].rows;
      std::sort(rows.begin(), rows.end());
      if (rows == wanted) return static_cast<int>(r);
    }
    return -1;
  }

  MapContent encode() {
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
    content.first_fallback = static_cast<std::uint32_t>(first_fallback_);
    TreeRegions tree;
    tree.p = planes_.p;
    addPlanes(content, tree);
    addRegions(content, tree);
    TreeOptions tree_options;
    tree_options.side_tolerance = options_.side_tolerance;
    if (first_fallback_ != 0) tree_options.side_tolerance *= kSharpSide;
    const ScaledPlanes planes{tree.p, tree.planes};
    PieceGeometry geometry(planes);
    PruneRegions regions{tree.rows, {}, content.regions.size()};
    for (const MapContent::Region& region : content.regions) regions.laws.push_back(region.law);
    if (first_fallback_ != 0) regions.first_fallback = first_fallback_;
    SearchTree found = pruneTree(geometry, regions, slack_, buildTree(tree, tree_options));
    content.solver_notes = notes(found.depth);
    content.root = found.root;
    content.nodes = std::move(found.nodes);
    content.leaves = std::move(found.leaves);
    content.candidates = std::move(found.candidates);
    return content;
  }

  /// Only planes that are still used; rows are renumbered.
  void addPlanes(MapContent& content, TreeRegions& tree) {
    const auto p = static_cast<std::size_t>(planes_.p);
    std::vector<std::int32_t> number(planes_.planes.size() / (p + 1), 0);
    for (const Entry& entry : entries_) {
      for (const std::int32_t row : entry.piece.rows) number[static_cast<std::size_t>(std::abs(row)) - 1] = 1;
    }
    std::int32_t next = 0;
    for (std::size_t i = 0; i < number.size(); ++i) {
      if (number[i] == 0) continue;
      number[i] = ++next;
      const double* const scaled = planes_.planes.data() + i * (p + 1);
      tree.planes.insert(tree.planes.end(), scaled, scaled + p + 1);
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
    for (Entry& entry : entries_) {
      for (std::int32_t& row : entry.piece.rows) {
        const std::int32_t plane = number[static_cast<std::size_t>(std::abs(row)) - 1];
        row = row > 0 ? plane : -plane;
      }
    }
  }

  void addRegions(MapContent& content, TreeRegions& tree) {
    const std::size_t width = map_.inputs().size() * (map_.parameters().size() + 1);
    std::map<std::uint32_t, std::uint32_t> laws;
    for (const Entry& entry : entries_) laws.emplace(entry.law, 0);
    std::uint32_t next = 0;
    for (auto& [law, number] : laws) {
      number = next++;
      content.laws.insert(content.laws.end(), map_.law(law), map_.law(law) + width);
    }
    for (const Entry& entry : entries_) {
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
      tree.rows.push_back(entry.piece.rows);
      tree.centres.insert(tree.centres.end(), entry.piece.centre.begin(), entry.piece.centre.end());
    }
  }

  std::string notes(std::uint32_t depth) const {
    char checksum[32];
    std::snprintf(checksum, sizeof checksum, "%016llx", static_cast<unsigned long long>(map_.checksum()));
    std::string text = "reduced_from: " + std::string(checksum) + "\n";
    text += "regions_before: " + std::to_string(map_.regionCount()) + "\n";
    text += "regions: " + std::to_string(entries_.size()) + "\n";
    text += "fallback_regions: " + std::to_string(fallbacks_.size()) + "\n";
    text += std::string("merge: ") + toString(options_.merge) + "\n";
    if (!stats_.separation.empty()) text += "separation: " + stats_.separation + "\n";
    return text + "tree_depth: " + std::to_string(depth) + "\n";
  }

  const RegionMap& map_;
  const ReduceOptions& options_;
  double slack_;
  ScaledPlanes planes_;  // those of the map, then those that were added
  RowList box_;
  std::vector<Piece> pieces_;  // per region
  std::vector<std::uint32_t> class_of_;
  std::vector<LawGroup> groups_;
  std::vector<std::uint32_t> replaced_;  // laws whose regions gave way to fallback regions
  std::vector<Entry> entries_, fallbacks_;
  std::size_t first_fallback_ = 0;
  ReduceStats stats_;
};

}  // namespace

const char* toString(MergeMethod method) {
  switch (method) {
    case MergeMethod::kNone:
      return "none";
    case MergeMethod::kGreedy:
      return "greedy";
    case MergeMethod::kOptimal:
      return "optimal";
    case MergeMethod::kAuto:
      return "auto";
  }
  return "unknown";
}

MapSize sizeOf(const RegionMap& map) {
  return {map.regionCount(), map.lawCount(), map.planeCount(), map.nodeCount(),
          map.leafCount(),   map.bytes(),    map.cost()};
}

ReduceResult reduce(const RegionMap& map, const ReduceOptions& options) {
  if (map.reducedFrom() != 0)
    throw Error(map.path() + ": reduce: was reduced before: reduce the map that it was made from");
  for (const Signal& signal : map.parameters()) {
    if (!(signal.lower < signal.upper))
      throw Error(map.path() + ": reduce: parameter " + signal.name + " has no range");
  }
  if (options.separate && map.inputs().size() != 1)
    throw Error(map.path() + ": reduce: --separate is for maps with one input, this one has " +
                std::to_string(map.inputs().size()));
  if (options.separate && map.solverStatus() != toString(ExploreStatus::kComplete))
    throw Error(map.path() + ": reduce: --separate needs a complete map, this one is '" +
                std::string(map.solverStatus()) + "'");
  return Reducer(map, options).run();
}

}  // namespace polyfly
