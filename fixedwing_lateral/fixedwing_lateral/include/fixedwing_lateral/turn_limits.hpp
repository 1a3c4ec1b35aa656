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
// The derivative of the right hand side by the angle between course and wind is never positive between 0 and pi. So a
// circle asks for most roll where it is flown downwind: tan(phi) = (V + |w|)^2 / (g R). Hence the least radius
//
//     R = (V + |w|)^2 / (g tan(phi_most)),
//
// 28.5 m at 14 m/s in calm and 64.2 m in a wind of 7 m/s, by 35 degrees. An aircraft that turns by turn_gain g tan(phi) /
// V + turn_bias needs tan(phi) = (v_g^2 k / cos(psi - chi) - V turn_bias) / (g turn_gain).
//
// Which changes of curvature can be flown. Where two segments meet, the roll would have to jump from phi_1 to phi_2.
// The roll loop spreads the jump by its impulse response, and the greatest roll rate p spreads it by a ramp of
// (phi_2 - phi_1) / p. Let a = g turn_gain (tan phi_2 - tan phi_1) be the jump of the lateral acceleration. It is
// spread with the variance c, and begins early by the mean delay. The aircraft ends on the right course and beside
// the path by
//
//     d = a c / 2,   c = (phi_2 - phi_1)^2 / (12 p^2) + max(0, (a1 / a0)^2 - 2 / a0),
//
// as the second moment of the response is what its double integral leaves. The second term is the variance of the
// roll loop of Eq. 45. From one turn to an opposite one, d is 0.5 m for the default loop with 35 degrees. It is 35 m
// for a loop that rolls by 9 deg/s. Therefore a path with a bound of d needs wider turns.
//
// Where the greatest roll rate is not known, nothing is known of the roll loop at this airspeed. Turns are then planned with
// a presumed rate: low, so that aircraft with slower loops than the Techpod's stay within the bound too. It falls with the
// airspeed as the rates of similar aircraft do (speed_scaling.hpp). model/roll_rate_max replaces it.

/// In what a path is to be flown.
struct TurnConditions {
  double airspeed = 14.0;  ///< V [m/s], > 0
  /// Wind speed, from any direction [m/s], >= 0.
  double wind_speed = 0.0;
  /// Greatest roll that turns may need, 35 degrees [rad], in (0, pi/2).
  double roll = 0.6108652381980153;
  /// Gain of the turn rate by roll, as learnt or calibrated [-], > 0.
  double turn_gain = 1.0;
  /// Bias of the turn rate, taken for the worse direction [rad/s], >= 0.
  double turn_bias = 0.0;
  /// Greatest roll rate; 0: no bound [rad/s], >= 0.
  double roll_rate = 0.0;
  /// Variance of the roll loop's impulse response [s^2], >= 0.
  double roll_variance = 0.0;
  /// Greatest deviation from the path where a turn follows another one; 0: no bound [m], >= 0.
  double deviation = 0.0;
};

/// The roll rate that turns are planned with where the greatest one is not known [rad/s].
double presumedRollRate(double airspeed) noexcept;

/// Variance of the impulse response of the roll loop [s^2]; 0 where it is negative, for a loop with little damping.
double rollVariance(const LateralModel& model) noexcept;

/// The deviation d [m] where the roll changes between two angles [rad].
double deviationOf(double from, double to, const TurnConditions& conditions) noexcept;

/// The greatest roll for planned turns [rad]. It is that of the conditions, or less where a turn followed by the
/// opposite one would deviate by more than the bound.
double plannedRoll(const TurnConditions& conditions) noexcept;

/// Throws polyfly::Error, beginning with `where`, if a number is out of its range.
void checkTurns(const TurnConditions& conditions, const std::string& where);

/// Of the circles that can be flown all around, by the planned roll [m]. Infinite where there is none, as in a wind
/// that is not below the airspeed.
double leastRadius(const TurnConditions& conditions) noexcept;

/// The roll [rad] that staying on the segment asks for where it is curved most, with the wind from the worst
/// direction. 0 on a line, pi/2 where the wind is not below the airspeed.
double steepestRoll(const PathSegment& segment, const TurnConditions& conditions);

/// The same with the conditions of a horizon. On a curve only the place nearest to `position` counts. Allocates nothing.
double steepestRoll(const PathSegment& segment, const Eigen::Vector2d& position,
                    const LateralConditions& conditions) noexcept;

/// A segment that asks for more roll than it may.
struct SteepSegment {
  int segment = 0;
  double roll = 0.0;  ///< [rad]
};

/// In order of flight.
std::vector<SteepSegment> steepSegments(const std::vector<PathSegment>& segments,
                                        const TurnConditions& conditions);

/// "segment 3 asks for 44 degrees of roll, and 2 more ..., where 35 are allowed: at 14.0 m/s in a wind of 7.0
/// m/s circles need 64.2 m". Empty where that is not the case.
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
