#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "region_maps/region_map.hpp"

namespace polyfly::bench {

/// A search tree whose leaves hold one law each and test nothing, so that it answers outside of the regions too. It is
/// what the literature builds (Tondel, Johansen and Bemporad, 2003; Arnstrom and Axehill, 2024): the mark for the
/// trees of maps.
struct LawTree {
  struct Node {
    /// Row p + 1 numbers of `planes`; children are nodes, or ~law.
    std::uint32_t plane = 0;
    std::int32_t below = 0;
    std::int32_t above = 0;
  };
  std::size_t parameters = 0;
  std::vector<double> planes;  ///< of the map
  std::vector<Node> nodes;     ///< the root first; empty: one law
  std::uint32_t depth = 0;
  /// The time limit was reached: there is no tree.
  bool is_late = false;

  std::uint32_t law(const double* theta) const;
  std::size_t usedPlanes() const;
};

/// Builds it from the regions of a map. Of the planes of a cell's regions it takes the one that leaves the fewest laws
/// on the fuller side, then the fewest regions on both sides, then the fewest regions on the fuller side, then the
/// fewest laws on the other one. Positions with respect to whole planes leave 20 candidates, positions within the
/// cell decide.
LawTree buildLawTree(const RegionMap& map, double time_limit);

}  // namespace polyfly::bench
