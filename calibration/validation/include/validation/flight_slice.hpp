#pragma once

#include <cstddef>
#include <vector>

#include "map_plot/slice.hpp"
#include "validation/replay.hpp"

namespace polyfly {

/// The slice of an axis' map that shows a flight, through position and velocity error. Each other parameter is at its
/// median over the samples inside the map. Without such samples it is at 0, or at the bound nearest to it. `axis`: 0
/// longitudinal, 1 lateral, 2 vertical.
SliceRequest flightSlice(const std::vector<ReplaySample>& samples, const RegionMap& map, std::size_t axis);

}  // namespace polyfly
