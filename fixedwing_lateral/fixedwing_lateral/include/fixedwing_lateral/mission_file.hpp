#pragma once

#include <string>

#include "fixedwing_lateral/mission.hpp"
#include "fixedwing_lateral/turn_limits.hpp"

namespace polyfly {

/// A mission from YAML. Points are (north, east) [m], poses (north, east, heading) [m, m, rad], angles
/// clockwise from north [rad]:
///
///     loiter: {radius: 80, direction: right}      # optional: flown at the end
///     turns: {airspeed: 14, wind: 7, roll: 0.55, tight: widen}    # optional: in what the turns must be
///     flyable path:                                       # one or more parts, in order of flight
///       - lines: [[0, 0], [300, 0], [300, 200]]
///       - dubins: {radius: 45, poses: [[300, 200, 1.5708], [100, 400, 3.1416]]}
///       - spline: [[100, 400], [0, 380], [-100, 430]]
///       - arc: {centre: [-100, 490], radius: 60, direction: left, start_bearing: 3.1416, sweep: 1.5}
///       - circle: {centre: [0, 0], radius: 60, direction: left}   # for ever, so the last
///
/// A part begins where the one before ends, within kPartGap; a circle may lie anywhere. Without a circle at
/// the end the mission ends in a loiter: the file's, else `loiter`.
///
/// With `turns` (the file's, else `turns`), a mission may ask for more roll in that wind from any direction. It is
/// refused (`tight: refuse`, the default), or Dubins paths and loiters are widened (`tight: widen`). A Dubins part
/// without a radius gets the least one.
///
/// Throws polyfly::Error `source:line: field: rule`. `source` names the text in complaints.
Mission parseMission(const std::string& text, const std::string& source, const LoiterOptions& loiter,
                     const TurnPlan& turns = {});

/// The same from a file; also where it cannot be read.
Mission loadMission(const std::string& path, const LoiterOptions& loiter, const TurnPlan& turns = {});

constexpr double kPartGap = 1.0;  ///< [m]

}  // namespace polyfly
