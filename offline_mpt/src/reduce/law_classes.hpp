#pragma once

#include <cstdint>
#include <vector>

namespace polyfly {

class RegionMap;

/// Per input: its greatest finite |bound|. Without one, the greatest |u| of a law in the box, at most 1.
std::vector<double> lawScales(const RegionMap& map);

/// For each law of the map the first law that it differs from by at most `tolerance` anywhere in the box,
/// relative to lawScales: itself, or one that comes before and stands for itself.
std::vector<std::uint32_t> lawClasses(const RegionMap& map, double tolerance);

}  // namespace polyfly
