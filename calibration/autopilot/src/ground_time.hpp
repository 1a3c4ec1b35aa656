#pragma once

#include <string>
#include <vector>

#include "autopilot/autopilot_log.hpp"
#include "identification/loop_record.hpp"

namespace polyfly {

/// When the vehicle stood, as its autopilot saw it.
struct GroundTime {
  std::string by;                   ///< message that tells; empty where the log has none
  std::vector<TimeWindow> windows;  ///< by the autopilot's clock [s], open at the log's ends
};

/// The messages that groundTime looks for, to be read with the log.
const std::vector<std::string>& groundTables();

/// PX4: vehicle_land_detected.landed. ArduPilot: STAT.isFlying (planes), else EV's landed and not landed
/// (copters), else EV's or ARM's armed and disarmed.
GroundTime groundTime(const AutopilotLog& log);

/// The series without what lies in the windows.
TimeSeries without(const TimeSeries& series, const std::vector<TimeWindow>& windows);

}  // namespace polyfly
