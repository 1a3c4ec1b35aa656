#pragma once

#include "autopilot/autopilot_log.hpp"
#include "identification/vehicle_kind.hpp"

namespace polyfly {

/// The table of a PX4 log that names the kind of vehicle.
constexpr const char* kVehicleTable = "vehicle_status";

/// The kind of vehicle as the autopilot logged it: unknown where it did not, or where it changed in flight
/// (a vehicle that takes off vertically).
VehicleKind loggedVehicle(const AutopilotLog& log);

}  // namespace polyfly
