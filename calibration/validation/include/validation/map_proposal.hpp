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
  /// Reason why there is no problem, or no count of its regions.
  std::string obstacle;
  /// Number of regions of the map as it is.
  std::size_t regions = 0;
  /// Number of regions of the proposed problem, counted by solving it.
  std::uint64_t regions_then = 0;
  /// True: all regions were counted. False: the limit was reached, and there are at least so many.
  bool counted_all = false;
  /// Samples in range but in no region. No range covers them.
  std::size_t infeasible = 0;
};

/// How long a proposal's regions are counted.
struct ProposalLimits {
  /// Greatest number of regions of a linear or quadratic problem. A robust problem is counted as a whole.
  std::uint64_t regions = 20000;
  /// Greatest time of exploring, or of a robust problem's feasible set, which is most of its work [s].
  double seconds = 60.0;
};

/// Proposes ranges that hold what the flight met (ParameterUse::proposedRange), writes them into the map's
/// problem text and counts the regions by solving it. None where the map held everything. The count is exact
/// or a lower bound, never a guess; of a robust problem it is exact or missing. Throws nothing for a problem
/// that cannot be changed or solved, or not within the limits: `obstacle` says why.
std::optional<MapProposal> proposeMap(const RegionMap& map, const MapUse& use, const std::string& axis,
                                      const ProposalLimits& limits = {});

}  // namespace polyfly
