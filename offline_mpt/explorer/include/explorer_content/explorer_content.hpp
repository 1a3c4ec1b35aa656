#pragma once

#include "map_explorer/explorer_page.hpp"

namespace polyfly {

class RegionMap;

/// What the problem text of a map tells the explorer. It tells the model of the closed loop, the program behind the
/// cost, and the names of the constraints. What the text does not tell is left out, with a sentence that says why.
/// Throws no Error for a text that cannot be read: the page then shows the map alone.
ExplorerContent explorerContent(const RegionMap& map);

}  // namespace polyfly
