#include "offline_mpt/reduce.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <numeric>
#include <vector>

#include "offline_mpt/partition.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/provenance.hpp"
#include "reduce/law_classes.hpp"
#include "reduce/merge.hpp"
#include "reduce/reduced_map.hpp"
#include "reduce/separate.hpp"
#include "reduce/tolerances.hpp"
#include "region_maps/region_map.hpp"
#include "support/in_parallel.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kMostFallbacks = 64;

/// Regions of the map with the same law.
struct LawGroup {
  std::uint32_t law = 0;
  // Regions with interior points.
  std::vector<std::uint32_t> regions;
  Merged merged;
};

class Reducer {
 public:
  Reducer(const RegionMap& map, const ReduceOptions& options)
      : map_(map),
        options_(options),
        slack_(tolerance::kMergingShare * map.tolerance()),
        planes_(ScaledPlanes::of(map)),
        box_(planes_.addBox()) {
    stats_.merge = options.merge;
  }

  ReduceResult run() {
    describeRegions();
    groupByLaw();
    if (options_.separate) separateSaturated();
    mergeAll();
    if (options_.separate) chooseFallbacks();
    collect();
    ReduceResult result;
    result.content = encodeReduced(map_, planes_, {entries_, first_fallback_, box_, slack_}, options_);
    result.content.solver_notes = notes(result.content.regions.size()) + result.content.solver_notes;
    result.stats = stats_;
    return result;
  }

 private:
  void describeRegions() {
    CellGeometry geometry(planes_, options_.stop);
    for (std::size_t r = 0; r < map_.regionCount(); ++r) {
      const RegionView region = map_.region(r);
      ConvexCell piece;
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
      if (is_new) groups_.push_back({law, {}, {}});
      if (pieces_[r].radius > tolerance::kEmptyInterior) groups_[found->second].regions.push_back(r);
      centres_.insert(centres_.end(), pieces_[r].centre.begin(), pieces_[r].centre.end());
      laws_.push_back(law);
    }
    stats_.laws = groups_.size();
  }

  void mergeAll() {
    const auto threads = static_cast<std::size_t>(std::clamp(options_.threads, 1, 256));
    std::vector<std::unique_ptr<CellGeometry>> geometries;
    for (std::size_t i = 0; i < threads; ++i)
      geometries.push_back(std::make_unique<CellGeometry>(planes_, options_.stop));
    const bool finished = inParallel(groups_.size(), static_cast<int>(threads), options_.stop,
                                     options_.progress, [&](std::size_t thread, std::uint64_t i) {
                                       groups_[i].merged = merge(*geometries[thread], groups_[i]);
                                     });
    if (!finished) throw ReductionStopped();
    for (const LawGroup& group : groups_) {
      if (group.merged.pieces.size() < group.regions.size()) ++stats_.merged_laws;
      if (options_.merge != MergeMethod::kNone)
        ++(group.merged.optimal ? stats_.optimal_laws : stats_.greedy_laws);
    }
  }

  Merged merge(CellGeometry& geometry, const LawGroup& group) const {
    MergeTask task;
    for (const std::uint32_t r : group.regions) task.pieces.push_back(pieces_[r]);
    task.centres = &centres_;
    task.laws = &laws_;
    task.law = group.law;
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
      if (!isConstantLaw(map_, group.law, tolerance::kConstantInput)) continue;
      const double value = map_.law(group.law)[p];
      if (best != nullptr && (upper ? value <= best_value : value >= best_value)) continue;
      best = &group;
      best_value = value;
    }
    if (best == nullptr) return nullptr;
    const Signal& input = map_.inputs().front();
    const double bound = upper ? input.upper : input.lower;
    const double scale = lawScales(map_).front();
    if (std::isfinite(bound) && std::abs(best_value - bound) > tolerance::kConstantInput * scale)
      return nullptr;
    return best;
  }

  std::vector<ConvexCell> piecesOf(const LawGroup* group) const {
    std::vector<ConvexCell> result;
    if (group == nullptr) return result;
    for (const std::uint32_t r : group->regions) result.push_back(pieces_[r]);
    return result;
  }

  void separateSaturated() {
    upper_ = saturatedGroup(true);
    lower_ = saturatedGroup(false);
    if (upper_ == lower_) lower_ = nullptr;  // one constant law: of either kind
    for (const LawGroup* group : {upper_, lower_}) {
      if (group == nullptr) continue;
      ++kinds_;
      stats_.saturated_regions += group->regions.size();
    }
    if (stats_.saturated_regions <= kinds_) return;
    CellGeometry geometry(planes_, options_.stop);
    const ConvexCell domain = domainOf(geometry, pieces_, box_, slack_);
    separation_ = separate(geometry, planes_, domain, piecesOf(upper_), piecesOf(lower_),
                           std::min(kMostFallbacks, stats_.saturated_regions - 1));
    // Nothing can be fewer than one for each kind: no need to join what gives way.
    if (separation_.done && separation_.fallbacks.size() <= kinds_) useFallbacks();
  }

  /// Fallback regions are used where they are fewer than the joined regions.
  void chooseFallbacks() {
    if (stats_.separated) return;
    std::size_t joined = 0;
    for (const LawGroup* group : {upper_, lower_})
      joined += group != nullptr ? group->merged.pieces.size() : 0;
    if (separation_.done && separation_.fallbacks.size() < joined) {
      useFallbacks();
      return;
    }
    stats_.separation =
        joined == 0        ? "no law is constant at a bound of the input"
        : joined <= kinds_ ? std::to_string(joined) + " saturated regions stay: as few as can be"
        : separation_.done
            ? std::to_string(joined) + " saturated regions stay: as many would take their place"
        : separation_.limited
            ? std::to_string(joined) +
                  " saturated regions stay: the search for planes stopped at its limit of " +
                  std::to_string(kMostSeparationSteps) + " linear programs"
            : std::to_string(joined) + " saturated regions stay: " +
                  "planes that were looked for one after the other do not separate them";
    stats_.saturated_regions = 0;
  }

  void useFallbacks() {
    for (const Fallback& part : separation_.fallbacks)
      fallbacks_.push_back({part.piece, (part.upper ? upper_ : lower_)->law, -1});
    for (LawGroup* group : {upper_, lower_}) {
      if (group == nullptr) continue;
      group->regions.clear();
      group->merged.pieces.clear();
      replaced_.push_back(group->law);
    }
    stats_.separated = true;
    stats_.fallback_regions = fallbacks_.size();
    stats_.separating_planes = separation_.planes;
    stats_.separation = std::to_string(stats_.saturated_regions) + " saturated regions gave way to " +
                        std::to_string(fallbacks_.size()) + " fallback regions, with " +
                        std::to_string(separation_.planes) + " planes between them";
  }

  void collect() {
    for (const LawGroup& group : groups_) {
      for (const ConvexCell& piece : group.merged.pieces)
        entries_.push_back({piece, group.law, sourceOf(group, piece)});
    }
    // Regions too thin to be joined stay as they are.
    for (std::uint32_t r = 0; r < pieces_.size(); ++r) {
      const std::uint32_t law = class_of_[map_.region(r).law];
      if (pieces_[r].radius > tolerance::kEmptyInterior ||
          std::find(replaced_.begin(), replaced_.end(), law) != replaced_.end())
        continue;
      entries_.push_back({pieces_[r], law, static_cast<int>(r)});
    }
    first_fallback_ = fallbacks_.empty() ? 0 : entries_.size();
    entries_.insert(entries_.end(), fallbacks_.begin(), fallbacks_.end());
  }

  /// The region of the map that has exactly these rows.
  int sourceOf(const LawGroup& group, const ConvexCell& piece) const {
    RowList wanted = piece.rows;
    std::sort(wanted.begin(), wanted.end());
    for (const std::uint32_t r : group.regions) {
      RowList rows = pieces_[r].rows;
      std::sort(rows.begin(), rows.end());
      if (rows == wanted) return static_cast<int>(r);
    }
    return -1;
  }

  std::string notes(std::size_t regions) const {
    std::string text = "reduced_from: " + hexDigits(map_.checksum()) + "\n";
    text += "regions_before: " + std::to_string(map_.regionCount()) + "\n";
    text += "regions: " + std::to_string(regions) + "\n";
    text += "fallback_regions: " + std::to_string(fallbacks_.size()) + "\n";
    text += std::string("merge: ") + toString(options_.merge) + "\n";
    if (!stats_.separation.empty()) text += "separation: " + stats_.separation + "\n";
    return text;
  }

  const RegionMap& map_;
  const ReduceOptions& options_;
  double slack_;
  // Planes of the map, then the planes that were added.
  ScaledPlanes planes_;
  RowList box_;
  // One piece for each region.
  std::vector<ConvexCell> pieces_;
  // Class of each law of the map.
  std::vector<std::uint32_t> class_of_;
  // Law of each region.
  std::vector<std::uint32_t> laws_;
  // Centre of each region.
  std::vector<double> centres_;
  std::vector<LawGroup> groups_;
  // Laws whose regions fallback regions replace.
  std::vector<std::uint32_t> replaced_;
  std::vector<ReducedRegion> entries_, fallbacks_;
  std::size_t first_fallback_ = 0;
  // Saturated at the upper and at the lower bound.
  LawGroup* upper_ = nullptr;
  LawGroup* lower_ = nullptr;
  // Number of kinds of saturation.
  std::size_t kinds_ = 0;
  Separation separation_;
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
  try {
    return Reducer(map, options).run();
  } catch (const ReductionStopped&) {
    throw Error(map.path() + ": reduce: interrupted, nothing was kept");
  }
}

}  // namespace polyfly
