#pragma once

#include <vector>

#include "map_regions.hpp"

namespace polyfly {

/// The half-spaces of the box and of regions that no region leaves by more than the tolerance, as distances (scaledRows),
/// without redundant ones and without those that repeat others up to rounding. A guess from rounded
/// vertices: what follows from it is to be proven.
std::vector<ExactHalfSpace> domainRows(const MapRegions& regions);

}  // namespace polyfly
