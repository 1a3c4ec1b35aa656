#pragma once

#include <Eigen/Core>
#include <string>

#include "online_controller/types/options.hpp"
#include "region_maps/error.hpp"

namespace polyfly {

/// Visitor of an options list (visitPlantOptions, visitFigureOptions): throws Error `group: key: rule` when a
/// value is out of its range or not finite.
struct RangeCheck {
  std::string group;

  void operator()(const char* key, double value, const char* unit, const Range& range) const {
    if (!(value >= range.least && value <= range.greatest)) {
      throw Error(group + ": " + key + ": must lie in [" + std::to_string(range.least) + ", " +
                  std::to_string(range.greatest) + "] " + unit + ", got " + std::to_string(value));
    }
  }

  void operator()(const char* key, const Eigen::Vector3d& value, const char* unit, const Range& range) const {
    for (int i = 0; i < 3; ++i) {
      (*this)(key, value[i], unit, range);
    }
  }
};

}  // namespace polyfly
