#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "validation/map_use.hpp"

namespace polyfly {

/// The problem that would have covered a flight: the map's own, with wider ranges of parameters.
struct MapProposal {
  struct Change {
    std::string parameter;
    std::string unit;
    double from[2] = {0.0, 0.0};  ///< range of the map [unit]
    double to[2] = {0.0, 0.0};    ///< proposed range [unit]
  };

  std::string axis;
  std::string map_path;
  std::vector<Change> changes;
  /// Text of the changed problem. Empty if it cannot be made.
  std::string problem;
  /// Reason why there is no problem.
  std::string obstacle;
  /// Samples in range but in no region. No range covers them.
  std::size_t infeasible = 0;
};

/// Proposes ranges that hold what the flight met (ParameterUse::proposedRange), and writes them into the map's problem
/// text. None where the map held everything. Throws nothing for a problem that cannot be changed: `obstacle` says why.
std::optional<MapProposal> proposeMap(const RegionMap& map, const MapUse& use, const std::string& axis);

}  // namespace polyfly
