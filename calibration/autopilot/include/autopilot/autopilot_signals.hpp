#pragma once

#include <map>
#include <string>
#include <vector>

#include "identification/flight_signals.hpp"

namespace polyfly {

struct AutopilotSignals {
  FlightSignals signals;             ///< times count from the first message that is used
  std::vector<std::string> remarks;  ///< of the log
};

/// Finds the signals of identification in an autopilot's own log, by its messages:
///
/// | signal | PX4 | ArduPilot |
/// |---|---|---|
/// | roll_cmd, pitch_cmd | vehicle_attitude_setpoint.roll_body ..., else .q_d | ATT.DesRoll ... |
/// | roll, pitch, yaw | vehicle_attitude.q | ATT.Roll ... |
/// | yaw_rate_cmd, yaw_rate | vehicle_rates_setpoint.yaw, vehicle_angular_velocity.xyz[2] | RATE.YDes, RATE.Y
/// | | thrust_cmd | vehicle_attitude_setpoint.thrust_body[2], else .thrust | CTUN.ThO | | specific_force_z |
/// sensor_combined.accelerometer_m_s2[2] | IMU.AccZ | | vx, vy, vz, vn, ve | vehicle_local_position.vx ... |
/// XKF1.VN ..., else NKF1 | | airspeed | airspeed_validated.true_airspeed_m_s, else airspeed | ARSP.Airspeed
/// |
///
/// Frames: forward-right-down and north-east-down become forward-left-up and east-north-up, for commands and
/// responses alike. `choice` names a place outright: `TABLE:FIELD`, a minus before it turns the sign, `:deg`
/// after it makes radians of degrees. Throws Error as readULog and readDataflash, and when a chosen place is
/// not there or there is no signal at all.
AutopilotSignals signalsFromAutopilot(const std::string& path,
                                      const std::map<std::string, std::string>& choice);

/// Whether the file begins as one of the two.
bool isAutopilotLog(const std::string& path);

}  // namespace polyfly
