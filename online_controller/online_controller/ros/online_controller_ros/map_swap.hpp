#pragma once

#include <online_controller/SwapMaps.h>

#include <array>
#include <vector>

#include "online_controller_ros/flight_record.hpp"
#include "online_controller_ros/law_setup.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly_ros {

/// The law whose maps a request is about. Throws Error where it names none.
polyfly::Law lawOfSwap(const online_controller::SwapMaps::Request& request);

/// The setup with other region maps. Makes the checks of the start, and those of a change in flight:
/// - the same sampling time and type of problem;
/// - no command at rest (tracking);
/// - an answer at the parameters of the last sample, where the map in force has one, and near that one.
/// `change` are the differences of these answers, NaN where there was nothing to compare. Throws Error naming file and
/// rule.
LawSetup withOtherMaps(const LawSetup& setup, const online_controller::SwapMaps::Request& request,
                       const FlightSnapshot* last, std::array<double, 3>& change);

/// Throws Error naming file and rule unless both maps have the same sampling time.
void requireSamePeriod(const polyfly::RegionMap& now, const polyfly::RegionMap& next);

/// Throws Error naming file and rule unless the next map has an answer at the parameters `last` (in the order of the map in
/// force) where that one has, and near it: each input differs by at most `most_change` of its range (0: 0.25). Returns the
/// greatest difference, NaN where there was nothing to compare.
double requireSimilar(const polyfly::RegionMap& now, const polyfly::RegionMap& next,
                      const std::vector<double>& last, double most_change);

}  // namespace polyfly_ros
