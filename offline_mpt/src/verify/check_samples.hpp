#pragma once

#include <Eigen/Core>
#include <vector>

namespace polyfly {

class RegionMap;

/// The parameters at which `solve` checks a map: uniform ones, centres of regions, and points just behind their facets. At
/// least 200; the map alone decides.
std::vector<Eigen::VectorXd> checkSamples(const RegionMap& map);

}  // namespace polyfly
