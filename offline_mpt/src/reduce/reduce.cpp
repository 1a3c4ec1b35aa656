#include "offline_mpt/reduce.hpp"

#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include "polyfly_base/error.hpp"
#include "polyfly_base/provenance.hpp"
#include "reduce/law_classes.hpp"
#include "reduce/merge.hpp"
#include "reduce/reduced_map.hpp"
#include "reduce/tolerances.hpp"
#include "region_maps/region_map.hpp"
#include "support/in_parallel.hpp"

namespace polyfly {
namespace {

/// Regions of the map with the same law.
struct LawGroup {
  std::uint32_t law = 0;
  // Regions with interior points.
  std::vector<std::uint32_t> regions;
  std::vector<ConvexCell> merged;
};

class Reducer {
 public:
  Reducer(const RegionMap& map, const ReduceOptions& options)
      : map_(map),
        options_(options),
        slack_(tolerance::kMergingShare * map.tolerance()),
        planes_(ScaledPlanes::of(map)),
        box_(planes_.addBox()) {}

  ReduceResult run() {
    describeRegions();
    groupByLaw();
    mergeAll();
    collect();
    ReduceResult result;
    result.content = encodeReduced(map_, planes_, {entries_, box_, slack_}, options_);
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
    const std::vector<std::uint32_t> class_of = lawClasses(map_, options_.law_tolerance);
    std::map<std::uint32_t, std::size_t> number;
    for (std::uint32_t r = 0; r < pieces_.size(); ++r) {
      const std::uint32_t law = class_of[map_.region(r).law];
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
    for (const LawGroup& group : groups_)
      stats_.merged_laws += group.merged.size() < group.regions.size() ? 1 : 0;
  }

  std::vector<ConvexCell> merge(CellGeometry& geometry, const LawGroup& group) const {
    MergeTask task;
    for (const std::uint32_t r : group.regions) task.pieces.push_back(pieces_[r]);
    task.centres = &centres_;
    task.laws = &laws_;
    task.law = group.law;
    task.box = box_;
    task.slack = slack_;
    return mergeGreedily(geometry, task);
  }

  void collect() {
    for (const LawGroup& group : groups_) {
      for (const ConvexCell& piece : group.merged)
        entries_.push_back({piece, group.law, sourceOf(group, piece)});
    }
    // Regions too thin to be joined stay as they are.
    for (std::uint32_t r = 0; r < pieces_.size(); ++r) {
      if (!(pieces_[r].radius > tolerance::kEmptyInterior))
        entries_.push_back({pieces_[r], laws_[r], static_cast<int>(r)});
    }
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
  // Law of each region.
  std::vector<std::uint32_t> laws_;
  // Centre of each region.
  std::vector<double> centres_;
  std::vector<LawGroup> groups_;
  std::vector<ReducedRegion> entries_;
  ReduceStats stats_;
};

}  // namespace

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
  try {
    return Reducer(map, options).run();
  } catch (const ReductionStopped&) {
    throw Error(map.path() + ": reduce: interrupted, nothing was kept");
  }
}

}  // namespace polyfly
