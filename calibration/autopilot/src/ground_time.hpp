#pragma once

#include <string>
#include <vector>

#include "autopilot/autopilot_log.hpp"
#include "identification/loop_record.hpp"

namespace polyfly {

/// When the vehicle stood, as its autopilot saw it.
struct GroundTime {
  /// Message that tells when the vehicle stood. Empty: the log has none.
  std::string by;
  /// Windows on the ground, by the autopilot's clock [s]. They are open at the ends of the log.
  std::vector<TimeWindow> windows;
};

/// The messages that groundTime looks for, to be read with the log.
const std::vector<std::string>& groundTables();

/// PX4: vehicle_land_detected.landed. ArduPilot: STAT.isFlying (planes), else EV's landed and not landed
/// (copters), else EV's or ARM's armed and disarmed.
GroundTime groundTime(const AutopilotLog& log);

}  // namespace polyfly
