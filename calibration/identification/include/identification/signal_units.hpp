#pragma once

#include <string>
#include <vector>

#include "identification/flight_signals.hpp"

namespace polyfly {

/// Checks units by physics, and names the option that helps; nothing is converted:
///
/// - roll, pitch and their commands lie within pi;
/// - the accelerometer shows gravity. One that does not is dropped.
///
/// Returns sentences. Throws Error where an angle is beyond pi in flight. Only flight is judged: upsets and ground
/// (findNonFlight, `on_ground` as there) are left out where most of the record is flight.
std::vector<std::string> checkUnits(FlightSignals* signals, bool on_ground = false);

/// The option that takes a signal for the other unit of angles, as a clause.
std::string otherUnit(const FlightSignals& signals, const std::string& name);

}  // namespace polyfly
