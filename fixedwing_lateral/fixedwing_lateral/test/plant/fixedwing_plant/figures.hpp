#pragma once

#include "fixedwing_lateral/turn_limits.hpp"

namespace polyfly {

/// Like Fig. 20: a box of lines, then a loiter. `size` multiplies all lengths, for other airspeeds.
Mission boxFigure(double size = 1.0);

/// Like Fig. 21, which gives no numbers: an arbitrary sequence of Dubins segments with arcs of 45 m, then a
/// loiter of 60 m. Both are wider where the plan says so.
Mission dubinsFigure(const TurnPlan& turns = {}, double size = 1.0);

/// Turns wide enough for that wind [m/s] from any direction at 14 m/s, by nine tenths of 35 degrees of roll.
TurnPlan turnsInWind(double wind_speed);

/// Segments between seeded waypoints with headings, as many as asked for or a few more, then a loiter.
Mission randomMission(int segments, unsigned seed);

}  // namespace polyfly
