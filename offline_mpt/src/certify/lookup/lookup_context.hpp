#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "certify/facet_cover_proof.hpp"
#include "certify/lookup/dropped_rows.hpp"
#include "certify/lookup/lookup_tree.hpp"
#include "certify/lookup/whole_planes.hpp"
#include "certify/region_check.hpp"

namespace polyfly {

/// What the proofs of all leaves need.
struct LookupContext {
  const CheckContext& check;
  const std::vector<RegionCheck>& checks;
  /// What lies behind each facet, by region.
  const std::vector<std::vector<FacetBehind>>& behind;
  const WholePlanes& planes;
  const LookupTree& tree;
  /// Rows that are dropped, by region.
  const std::vector<RegionDrops>& drops;
  /// Coverage is that of the regions moved outwards.
  bool widened = false;

  /// The row of a region where it was dropped on the way to a leaf, nullptr if it was not.
  const DroppedRow* findDropped(std::size_t visit, std::uint32_t region, std::uint32_t row) const {
    for (;; visit = tree.parent(visit)) {
      for (const DroppedRow& dropped : drops[region].at(visit)) {
        if (dropped.row == row) return &dropped;
      }
      if (visit == 0) return nullptr;
    }
  }
};

}  // namespace polyfly
