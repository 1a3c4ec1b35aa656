#pragma once

#include <string>
#include <vector>

#include "certify/region_check.hpp"

namespace polyfly {

/// Regions that the map leaves out because they are narrower than its tolerance. They close the exact
/// partition; each is proven to lie in the map's regions with half-spaces moved outwards by the plane
/// tolerance.

/// `row` moved outwards by at most `distance` [scaled].
ExactRow relaxedRow(const ExactRow& row, const Rational& distance);

/// Whether the region, its rows rounded, holds t but for twice the plane tolerance.
bool nearlyHolds(const CheckContext& context, const std::vector<RegionCheck>& checks, std::uint32_t region,
                 const std::vector<Rational>& t);

/// Rows that bound the region: no other, and not the box, implies them.
std::vector<ExactRow> boundingRows(const ExactRegion& exact, int p);

/// The region of an active set that the map has not, and why it can be left out; false where it has no
/// interior, or is no sliver. `checks` are those of the map's regions, and then any number of slivers.
bool checkSliver(const CheckContext& context, const std::vector<RegionCheck>& checks,
                 const std::vector<int>& active, RegionCheck& sliver);

}  // namespace polyfly
