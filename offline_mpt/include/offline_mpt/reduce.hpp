#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "offline_mpt/search_tree.hpp"
#include "region_maps/lookup.hpp"
#include "region_maps/map_content.hpp"

namespace polyfly {

class RegionMap;

/// How regions of one law are joined.
enum class MergeMethod : std::uint8_t {
  kNone,
  /// Joins pairs (Bemporad, Fukuda and Torrisi, 2001).
  kGreedy,
  /// Finds the fewest convex unions (Geyer, Torrisi and Morari, 2008). Beyond the limits below: kGreedy.
  kOptimal,
  /// As kOptimal, with lower limits.
  kAuto,
};

const char* toString(MergeMethod method);

struct ReduceOptions {
  MergeMethod merge = MergeMethod::kAuto;
  bool separate = false;  ///< let few fallback regions take the place of saturated ones
  /// Laws that differ by less anywhere in the box are one, relative to the greatest finite |bound| of the input. Without
  /// one, relative to the greatest |u| of a law in the box, at most 1.
  double law_tolerance = 1e-9;
  /// How far the search tree grows. kSmall: as far as it shortens look-ups. These leave out rows that the way to a leaf
  /// implies, and cells of the tree that hold one law become regions. kAuto: at most two nodes per region, and look-ups
  /// test all rows.
  TreeMode tree = TreeMode::kAuto;
  /// TreeOptions::side_tolerance; a tenth of it where there are fallback regions.
  double side_tolerance = 1e-9;
  int threads = 1;                          ///< 1..256; the result does not depend on it
  const std::atomic<bool>* stop = nullptr;  ///< set from outside to end early: Error
  /// Called now and then from the calling thread, with laws that are done.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
  /// The same while search trees grow: TreeOptions::progress.
  std::function<void(std::uint64_t done, std::uint64_t total)> tree_progress;
};

/// Arrangements up to this size are merged optimally.
constexpr std::size_t kAutoPlanes = 24, kAutoCells = 1000;
constexpr std::size_t kOptimalPlanes = 64, kOptimalCells = 10'000;

/// What a map takes.
struct MapSize {
  std::size_t regions = 0;
  std::size_t laws = 0;
  std::size_t planes = 0;
  std::size_t nodes = 0;
  std::size_t leaves = 0;
  std::size_t bytes = 0;
  LookupCost cost;
};

MapSize sizeOf(const RegionMap& map);

struct ReduceStats {
  MergeMethod merge = MergeMethod::kNone;
  /// Distinct laws, by ReduceOptions::law_tolerance.
  std::size_t laws = 0;
  /// Laws with fewer regions than before.
  std::size_t merged_laws = 0;
  /// Laws that the fewest convex unions of the regions' planes describe.
  std::size_t optimal_laws = 0;
  /// Laws that were merged without a proof that the unions are the fewest.
  std::size_t greedy_laws = 0;
  bool separated = false;
  /// A sentence: what was done, or why not. Empty: not asked for.
  std::string separation;
  /// Saturated regions that fallback regions replaced.
  std::size_t saturated_regions = 0;
  std::size_t fallback_regions = 0;
  std::size_t separating_planes = 0;
};

struct ReduceResult {
  MapContent content;
  ReduceStats stats;
};

/// A map with the same answers from fewer regions. Regions of one law are joined where their union is convex;
/// joined regions of one law may overlap.
///
/// With `separate`, and one input: where the input is constant at its greatest or least value, the regions are left
/// out. Fallback regions (FORMAT.md) take their place. They are the whole set of parameters that the map answers,
/// divided by planes. These keep the two kinds of saturation apart (Kvasnica, Hledik, Rauova and Fikar, 2013). One
/// plane where one is enough; else a list of planes, each cutting off regions of one kind. The regions stay where
/// that would not be fewer.
///
/// Decisions are made in floating point: prove the result (verify_reduction.hpp). Throws Error for a map that
/// was reduced before; with `separate` for one that is not complete or has several inputs; when stopped.
ReduceResult reduce(const RegionMap& map, const ReduceOptions& options = {});

std::string reduceText(const ReduceStats& stats, const MapSize& before, const MapSize& after);
std::string reduceJson(const ReduceStats& stats, const MapSize& before, const MapSize& after, bool proven);

}  // namespace polyfly
