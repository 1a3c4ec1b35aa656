#pragma once

#include <Eigen/Core>

#include "polyfly_base/range_check.hpp"

namespace polyfly {

/// RangeCheck for options with vectors (visitPlantOptions, visitFigureOptions).
struct VectorRangeCheck : RangeCheck {
  using RangeCheck::operator();
  void operator()(const char* key, const Eigen::Vector3d& value, const char* unit, const Range& range) const {
    for (Eigen::Index i = 0; i < value.size(); ++i) (*this)(key, value[i], unit, range);
  }
};

}  // namespace polyfly
