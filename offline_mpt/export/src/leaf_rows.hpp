#pragma once

#include <cstdint>
#include <vector>

#include "lookup_tables.hpp"
#include "region_maps/map_content.hpp"

namespace polyfly {

/// Finds the rows of a region that a leaf of exported code has to test. What it finds needs no proof of its own: the
/// code is proven with it.
class LeafRows {
 public:
  /// Both outlive the object. The code has the map's planes (withPlanesOf).
  LeafRows(const checker::Map& map, const checker::LookupTables& code);

  /// Those of the rows `tests` that a parameter in the leaf may violate by more than the tolerance while it holds the
  /// others, as MapContent::tests has them.
  std::uint32_t testsOf(std::uint32_t leaf, std::uint32_t region,
                        std::uint32_t tests = MapContent::kAllRows) const;

 private:
  std::vector<std::uint32_t> rowsOf(std::uint32_t region) const;
  double violation(std::uint32_t leaf, const std::vector<std::uint32_t>& rows, std::uint32_t i,
                   std::uint32_t tests) const;
  checker::HalfSpace halfSpace(std::uint32_t row, double limit) const;

  const checker::Map& map_;
  const checker::LookupTables& code_;
  /// The rows on a way to a leaf, as LookupTables::Candidate has them.
  using Path = std::vector<std::uint32_t>;
  /// Of each leaf.
  std::vector<std::vector<Path>> paths_;
};

}  // namespace polyfly
