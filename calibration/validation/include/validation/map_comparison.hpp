#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "validation/difference.hpp"
#include "validation/lookup_times.hpp"
#include "validation/map_use.hpp"
#include "validation/replay.hpp"

namespace polyfly {

/// Another map of an axis on a flight: looked up at the same parameters, by their names, as the map that
/// flew. Models or weights may differ; the flight that it would have flown is not simulated.
struct MapComparison {
  std::string axis;
  std::string path;
  std::string input_unit;
  /// Use of the other map.
  MapUse use;
  /// Samples inside both maps.
  std::size_t both = 0;
  /// Samples inside the flown map only.
  std::size_t only_flown = 0;
  /// Samples inside the other map only.
  std::size_t only_other = 0;
  /// Difference |flown - other| of the first input, over samples inside both maps.
  Difference difference;
  /// Difference between the other map and the online solution of its own problem.
  Difference qp;
  /// Samples inside the other map where the solver found no solution.
  std::size_t qp_failures = 0;
  /// Look-up times of the other map, in the order of the flight [ns].
  Percentiles lookup_ns;
};

/// Compares on the samples with a reference. `axis` is the axis of both. Throws Error naming map and parameter when the
/// other map has a parameter that the flown one does not have.
MapComparison compareMaps(const std::vector<ReplayedFlight>& flights, const RegionMap& flown,
                          const RegionMap& other, std::size_t axis);

/// Another map of an axis.
struct OtherMap {
  std::size_t axis = 0;  ///< 0 longitudinal, 1 lateral, 2 vertical
  const RegionMap* map = nullptr;
};

/// The first map of each axis, in the order given, and those after it. Throws Error as assignAxes.
struct MapChoice {
  AxisMaps flown{};
  std::vector<OtherMap> others;
};
MapChoice chooseMaps(const std::vector<const RegionMap*>& maps);

}  // namespace polyfly
