#pragma once

#include <string>
#include <vector>

#include "identification/flight_signals.hpp"

namespace polyfly {

/// Checks units and signs by physics, and names the option that helps; nothing is converted:
///
/// - roll, pitch and their commands lie within pi;
/// - what roll and pitch change by is the integral of gyro_x and gyro_y;
/// - the accelerometer shows gravity. One that does not is dropped.
///
/// Returns sentences. Throws Error where an angle is beyond pi in flight. Only flight is judged: upsets and ground
/// (findNonFlight, `on_ground` as there) are left out where most of the record is flight.
std::vector<std::string> checkUnits(FlightSignals* signals, bool on_ground = false);

}  // namespace polyfly
