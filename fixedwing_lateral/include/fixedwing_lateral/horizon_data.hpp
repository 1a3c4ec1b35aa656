#pragma once

#include "fixedwing_lateral/model.hpp"
#include "fixedwing_lateral/path.hpp"

namespace polyfly {

/// What a horizon flies along and in: at most two segments.
struct HorizonData {
  LateralConditions conditions;  ///< its gate is at the end of `current`
  PathSegment current;
  PathSegment next;  ///< past the gate; `current` once more where nothing follows
};

}  // namespace polyfly
