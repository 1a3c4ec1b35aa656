#pragma once

#include <string>
#include <vector>

#include "fixedwing_lateral/mission.hpp"
#include "fixedwing_lateral/model.hpp"

namespace polyfly {

// Which circles can be flown in wind. Along a path of curvature k the course turns at chi' = v_g k, with the
// ground speed v_g. Across the path, air velocity and wind w must cancel: V sin(psi - chi) = -w . n(chi). Its
// derivative by time is V cos(psi - chi) (psi' - chi') = (w . t) chi', and as v_g = V cos(psi - chi) + w . t,
//
//     psi' = chi' v_g / (V cos(psi - chi)),   so by Eq. 45   tan(phi) = V psi' / g = v_g^2 k / (g cos(psi -
//     chi)).
//
// The derivative of the right hand side by the angle between course and wind is never positive between 0 and
// pi, so a circle asks for most roll where it is flown downwind: tan(phi) = (V + |w|)^2 / (g R). Hence the
// least radius
//
//     R = (V + |w|)^2 / (g tan(phi_most)),
//
// 28.5 m at 14 m/s in calm and 64.2 m in a wind of 7 m/s, by 35 degrees.

/// In what a path is to be flown.
struct TurnConditions {
  double airspeed = 14.0;  ///< V [m/s], > 0
  /// Wind speed, from any direction [m/s], >= 0.
  double wind_speed = 0.0;
  /// Greatest roll that turns may need, 35 degrees [rad], in (0, pi/2).
  double roll = 0.6108652381980153;
  double gravity = 9.81;  ///< [m/s^2], > 0
};

/// Throws polyfly::Error, beginning with `where`, if a number is out of its range.
void checkTurns(const TurnConditions& conditions, const std::string& where);

/// Of the circles that can be flown all around [m]; infinite where the wind is not below the airspeed.
double leastRadius(const TurnConditions& conditions) noexcept;

/// The roll [rad] that staying on the segment asks for where it is curved most, with the wind from the worst
/// direction; 0 on a line, pi/2 where the wind is not below the airspeed.
double steepestRoll(const PathSegment& segment, const TurnConditions& conditions);

/// The same with the conditions of a horizon, of whose wind the direction is known: on an arc the course
/// nearest to downwind counts, on a curve only the place nearest to `position`. Allocates nothing.
double steepestRoll(const PathSegment& segment, const Eigen::Vector2d& position,
                    const LateralConditions& conditions, double gravity) noexcept;

/// A segment that asks for more roll than it may.
struct SteepSegment {
  int segment = 0;
  double roll = 0.0;  ///< [rad]
};

/// In order of flight.
std::vector<SteepSegment> steepSegments(const std::vector<PathSegment>& segments,
                                        const TurnConditions& conditions);

/// "segment 3 asks for 44 degrees of roll, and 2 more ..., where 35 are allowed: at 14.0 m/s in a wind of 7.0
/// m/s circles need 64.2 m"; empty where no segment is too steep.
std::string describeSteep(const std::vector<PathSegment>& segments, const TurnConditions& conditions);

/// What becomes of a mission with turns that cannot be flown.
enum class TightTurns : std::uint8_t {
  kKeep,    ///< it is flown as it is, and left where it cannot be followed
  kRefuse,  ///< Error
  /// Dubins paths and loiters get the least radius; Error for what cannot be widened: arcs and curves.
  kWiden,
};

/// "keep", "refuse", "widen". Throws polyfly::Error, beginning with `where`, on another name.
TightTurns tightTurnsOf(const std::string& name, const std::string& where);

struct TurnPlan {
  TightTurns tight = TightTurns::kKeep;
  TurnConditions conditions;

  /// For a path that is still to be planned: the radius, widened where that is asked for [m].
  double planned(double radius) const noexcept;
};

/// A mission by the plan. A loiter that is widened keeps the place and the direction in which the segment
/// before meets it, or its centre where none does. Throws polyfly::Error, beginning with `where` and the
/// segment's number.
Mission fitTurns(Mission mission, const TurnPlan& plan, const std::string& where);

}  // namespace polyfly
