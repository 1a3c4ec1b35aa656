#pragma once

#include <Eigen/Core>

#include "polyfly_base/range_check.hpp"

namespace polyfly {

/// RangeCheck for options with vectors (visitPlantOptions, visitFigureOptions).
struct VectorRangeCheck : RangeCheck {
  using RangeCheck::operator();
  void operator()(const char* key, const Eigen::Vector3d& value, const char* unit, const Range& range) const {
    for (const double entry : value) (*this)(key, entry, unit, range);
  }
};

}  // namespace polyfly
