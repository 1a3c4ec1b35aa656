#pragma once

#include <visualization_msgs/Marker.h>

#include <cstddef>
#include <vector>

#include "region_maps/region_map.hpp"
#include "validation/replay.hpp"

namespace polyfly_ros {

/// The slice of an axis' map through position and velocity error, with the flight in it, for rviz. In the frame
/// "map_slices" each slice is a square of 2 m, the three axes stand beside each other along x:
///
/// - NAME/regions (LINE_LIST): outlines of the regions that the slice cuts
/// - NAME/flown (POINTS): the samples, projected on the slice; green inside the map, red outside
/// - NAME/title (TEXT_VIEW_FACING)
///
/// NAME is longitudinal, lateral or vertical; `axis` its index. Samples without a reference are left out, and those
/// beyond the drawn square.
std::vector<visualization_msgs::Marker> sliceMarkers(const std::vector<polyfly::ReplaySample>& samples,
                                                     const polyfly::RegionMap& map, std::size_t axis);

}  // namespace polyfly_ros
