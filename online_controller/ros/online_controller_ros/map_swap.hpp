#pragma once

#include <online_controller/SwapMaps.h>

#include <array>

#include "online_controller_ros/flight_snapshot.hpp"
#include "online_controller_ros/law_setup.hpp"

namespace polyfly_ros {

/// The setup with other region maps, after every check of the start and those of a change in flight: the same
/// period and kind of problem, nothing commanded at rest (tracking), and at the parameters of the last sample
/// an answer where the map in force has one, no further from it than allowed. `change` are those differences,
/// NaN where there was nothing to compare. Throws Error naming file and rule.
LawSetup withOtherMaps(const LawSetup& setup, const online_controller::SwapMaps::Request& request,
                       const FlightSnapshot* last, std::array<double, 3>& change);

}  // namespace polyfly_ros
