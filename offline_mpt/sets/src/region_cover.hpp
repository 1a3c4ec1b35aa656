#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "map_regions.hpp"
#include "polytope_sets/exact_polytope.hpp"

namespace polyfly {

/// A cell that lies in no region as it is, but in `region` with its half-spaces moved outwards.
struct CoverSliver {
  std::uint32_t region;
  std::vector<std::vector<Integer>> vertices;
};

/// What came of a set, or of a part of it.
struct SetCover {
  /// Every point lies in a region whose half-spaces are moved outwards by the tolerance.
  bool covered = true;
  std::vector<CoverSliver> slivers;
  /// A point of the set, well inside, that is in no region; empty where it is covered.
  RationalVector gap;
};

/// Covers a bounded set of parameters by the regions of a map: the search tree cuts it into parts, and what lies outside of
/// a candidate of a leaf is covered by the others. The answer does not depend on the number of threads. `progress` is called
/// now and then from the calling thread with the parts of the set that are done, and with all.
SetCover coverSet(const MapRegions& regions, const ExactPolytope& set, int threads,
                  const std::function<void(std::uint64_t done, std::uint64_t total)>& progress);

}  // namespace polyfly
