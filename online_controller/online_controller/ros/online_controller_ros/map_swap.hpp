#pragma once

#include <online_controller/SwapMaps.h>

#include <array>

#include "online_controller_ros/flight_snapshot.hpp"
#include "online_controller_ros/law_setup.hpp"

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

}  // namespace polyfly_ros
