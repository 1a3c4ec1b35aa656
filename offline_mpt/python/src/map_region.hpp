#pragma once

#include <cstddef>

#include "loaded_map.hpp"

namespace polyfly::python {

/// A critical region of a map that Python keeps.
struct MapRegion {
  const LoadedMap* map = nullptr;
  std::size_t index = 0;

  RegionView data() const { return map->map().region(index); }
};

/// The regions of a map that Python keeps, as a sequence.
struct RegionList {
  const LoadedMap* map = nullptr;
};

}  // namespace polyfly::python
