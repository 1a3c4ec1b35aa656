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

/// What is said of the options `merge` and `separate`, which were removed.
constexpr const char* kNoMerge = "was removed; regions of one law are always joined in pairs";
constexpr const char* kNoSeparate = "was removed; leave it out, the tree `small` shortens look-ups too";

struct ReduceOptions {
  /// Laws that differ by less anywhere in the box are one, relative to the greatest finite |bound| of the input. Without
  /// one, relative to the greatest |u| of a law in the box, at most 1.
  double law_tolerance = 1e-9;
  /// How far the search tree grows. kSmall: as far as it shortens look-ups. These leave out rows that the way to a leaf
  /// implies, and cells of the tree that hold one law become regions. kAuto: at most two nodes per region, and look-ups
  /// test all rows.
  TreeMode tree = TreeMode::kAuto;
  /// TreeOptions::side_tolerance.
  double side_tolerance = 1e-9;
  int threads = 1;                          ///< 1..256; the result does not depend on it
  const std::atomic<bool>* stop = nullptr;  ///< set from outside to end early: Error
  /// Called now and then from the calling thread, with laws that are done.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
  /// The same while search trees grow: TreeOptions::progress.
  std::function<void(std::uint64_t done, std::uint64_t total)> tree_progress;
};

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
  /// Distinct laws, by ReduceOptions::law_tolerance.
  std::size_t laws = 0;
  /// Laws with fewer regions than before.
  std::size_t merged_laws = 0;
};

struct ReduceResult {
  MapContent content;
  ReduceStats stats;
};

/// A map with the same answers from fewer regions. Pairs of regions of one law are joined where their union is convex
/// (Bemporad, Fukuda and Torrisi, 2001); joined regions of one law may overlap.
///
/// Decisions are made in floating point: prove the result (verify_reduction.hpp). Throws Error for a map that
/// was reduced before, and when stopped.
ReduceResult reduce(const RegionMap& map, const ReduceOptions& options = {});

std::string reduceText(const ReduceStats& stats, const MapSize& before, const MapSize& after);
std::string reduceJson(const ReduceStats& stats, const MapSize& before, const MapSize& after, bool proven);

}  // namespace polyfly
