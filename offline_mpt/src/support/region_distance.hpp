#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdlib>

#include "region_maps/region_map.hpp"

namespace polyfly {

/// Whether theta is no further outside of each half-space of a region than `most` [scaled].
inline bool isWithin(const RegionMap& map, std::size_t region, const Eigen::VectorXd& theta, double most) {
  const RegionView view = map.region(region);
  return std::all_of(view.rows, view.rows + view.row_count, [&](std::int32_t row) {
    const double* const plane = map.plane(static_cast<std::size_t>(std::abs(row)) - 1);
    const double distance =
        Eigen::Map<const Eigen::VectorXd>(plane, theta.size()).dot(theta) - plane[theta.size()];
    return (row > 0 ? distance : -distance) <= most;
  });
}

}  // namespace polyfly
