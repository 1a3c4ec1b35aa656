#pragma once

#include <map>
#include <string>
#include <vector>

#include "identification/flight_signals.hpp"

namespace polyfly {

struct AutopilotSignals {
  /// Signals of the flight. Times count from the first message that is used. `not_flight` says when the vehicle
  /// stood.
  FlightSignals signals;
  /// Remarks on the log.
  std::vector<std::string> remarks;
};

/// Finds the signals of identification in an autopilot's own log, by its messages:
///
/// - roll_cmd, pitch_cmd: vehicle_attitude_setpoint.roll_body, .pitch_body, else .q_d; ATT.DesRoll, .DesPitch, else
///   ATT.RollIn, .PitchIn, else CTUN.NavRoll, .NavPitch
/// - roll, pitch, yaw: vehicle_attitude.q, else .roll, .pitch, .yaw; ATT.Roll, .Pitch, .Yaw
/// - yaw_rate_cmd: vehicle_rates_setpoint.yaw; RATE.YDes, else .YawDes
/// - yaw_rate: vehicle_angular_velocity.xyz[2], else vehicle_attitude.yawspeed, else sensor_combined.gyro_rad[2];
///   RATE.Y, else .Yaw
/// - thrust_cmd (a share of full thrust): vehicle_attitude_setpoint.thrust_body[2], else .thrust, else of
///   vehicle_rates_setpoint; CTUN.ThO, else .ThrOut
/// - specific_force_z: sensor_combined.accelerometer_m_s2[2], else vehicle_acceleration.xyz[2]; IMU.AccZ
/// - vx, vy, vz, vn, ve: vehicle_local_position.vx ...; XKF1.VN ..., else NKF1, EKF1,
///   else GPS.Spd, .GCrs, .VZ
/// - gyro_z: sensor_combined.gyro_rad[2]; IMU.GyrZ. By it the reader tells the unit of RATE
///
/// The kind of vehicle is that of vehicle_status, and of the messages that only ArduPlane or ArduCopter writes.
///
/// Frames: forward-right-down and north-east-down become forward-left-up and east-north-up, for commands and
/// responses alike. A command is taken as the straight line between the values that were logged, which are some of
/// those that were sent. What was measured while the vehicle stood, by the autopilot's own account
/// (vehicle_land_detected, STAT, EV, ARM), is left out unless `on_ground`. `choice` names a place outright:
/// `TABLE:FIELD`, a minus before it turns the sign, `:deg` after it makes radians of degrees. Throws Error as
/// readULog and readDataflash. Also when a chosen place is not there, there is no signal at all, or the vehicle never
/// left the ground.
AutopilotSignals signalsFromAutopilot(const std::string& path,
                                      const std::map<std::string, std::string>& choice,
                                      bool on_ground = false);

/// Whether the file begins as one of the two.
bool isAutopilotLog(const std::string& path);

}  // namespace polyfly
