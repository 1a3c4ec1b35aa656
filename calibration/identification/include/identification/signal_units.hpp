#pragma once

#include <string>
#include <vector>

#include "identification/flight_signals.hpp"

namespace polyfly {

/// Checks units and signs of the signals by physics, and converts where a factor is certain:
///
/// - what an angle changes by is the integral of its rate (roll with gyro_x, pitch with gyro_y, yaw with yaw_rate or
///   gyro_z), and yaw_rate is gyro_z;
/// - a command is as great as its response, if the response has passed its own check or the command is beyond pi;
/// - the accelerometer shows gravity.
///
/// A factor is certain under three conditions. The two signals correlate by 0.8. They differ by 57.3 (degrees), 5730
/// (hundredths of degrees) or 100, up to 30 %. The size of one of them cannot be that of a flight. Returns a sentence
/// for each signal that was converted or dropped, and for each sign that differs. Drops an accelerometer without
/// gravity. Throws Error naming file, signal and factor where a factor is clear but not which of two signals is
/// wrong. Also where an angle is beyond pi in flight and no rate tells its unit.
///
/// Only flight is judged: upsets and ground (findNonFlight, `on_ground` as there) are left out where most of the record is
/// flight.
std::vector<std::string> settleUnits(FlightSignals* signals, bool on_ground = false);

}  // namespace polyfly
