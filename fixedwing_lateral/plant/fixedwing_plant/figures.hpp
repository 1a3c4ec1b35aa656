#pragma once

#include "fixedwing_lateral/mission.hpp"

namespace polyfly {

/// Like Fig. 20: a box of lines, then a loiter.
Mission boxFigure();

/// Like Fig. 21: an arbitrary sequence of Dubins segments, then a loiter.
Mission dubinsFigure();

/// Segments between seeded waypoints with headings, as many as asked for or a few more, then a loiter.
Mission randomMission(int segments, unsigned seed);

}  // namespace polyfly
