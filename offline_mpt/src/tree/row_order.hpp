#pragma once

#include "region_maps/map_content.hpp"

namespace polyfly {

/// Rows that many leaves test come first in their region: a look-up then reads fewer of them. Row 31 and those after it,
/// which share one bit of MapContent::tests, stay where they are.
void orderRows(MapContent& content);

}  // namespace polyfly
