#pragma once

#include "fixedwing_lateral/model.hpp"
#include "fixedwing_lateral/tuning.hpp"

namespace polyfly {

// Weights that belong to one airspeed V_0, at another one V.
//
// Let s = V / V_0. With times in units of s, lengths in units of s^2 and the same roll, Eq. 45 at V is Eq. 45 at V_0.
// n' = V cos psi and psi' = g tan(phi) / V keep their form. The least radius V^2 / (g tan phi) is the same number. So
// a flight at V is a slow copy of the one at V_0 if
//
//   the horizon lasts s times as long (it then reaches as many turn radii ahead), and
//   track is divided by s^4, roll_rate is multiplied by s^2, and the other weights stay.
//
// The roll loop is the only thing that does not slow down. That is to the good where it is fast. Near the path no
// bound is active, and the published weights would do at each airspeed. There e_t'' = -g phi whatever V is, so the
// optimal feedback has the frequency
//
//   w = (g^2 track / roll_reference)^(1/4) = 0.56 rad/s.
//
// An error e asks for a roll of w^2 e / g and for a roll rate of w^3 e / g. A loop that can do the rate p flies the
// full weight up to e_near = g p / w^3. A larger error needs a weight in proportion to w^4, so to e^(-4/3). Therefore
// the weight is divided by s^4 far away, and rises to the given one where the horizon stays near the path:
//
//   share = min(1, max(s^-4, (e_near / e)^(4/3))),   e: the largest |e_t| in the horizon.
//
// e_near is kNearTime V for the published weights: 13 m at 52 m/s, which needs 13 deg/s. With a larger w it is less by
// w^3.
//
// At and below V_0 the share is 1 and nothing changes: a slower aircraft has no faster roll loop.

// Corners. The acceptance radius belongs to V_0 too. A turn's radius grows with the square of the ground speed, so
// the radius at corners that are switched at their bisector does. On the bisector the path is cut as far on the
// inside as it is passed on the outside. That holds if the horizon sees the turn to its end. A turn by the angle
// alpha at the ground speed v is
//
//     v^2 alpha / (g tan(phi_most)) + v a1 / a0
//
// long, with the mean delay of the roll loop. In wind that can be more than v T, which the horizon of length T sees;
// then it would begin the turn late. The corner is switched earlier by half of what it does not see. Downwind that
// halves the error over a corner (rms 3.0 m to 1.8 at 14 m/s in a wind of 7 m/s). In calm a right angle needs none.
//
// At a bisector the radius only bounds where the corner is sought, so it is that of the fastest direction. A law that
// does not look ahead switches on the radius itself: it grows with the ground speed v in the direction of this
// corner. So does the radius of a sharp corner without a bisector, with the greater one of V and v along the segment.
// The reason is that the turn ends the other way.

/// What an airspeed makes of the options.
struct SpeedScaling {
  /// s = V / V_0, at least 1.
  double scale = 1.0;
  /// Step of the horizon [s].
  double step = 0.1;
  /// Error up to which the full weight of e_t holds, e_near [m].
  double near = 0.0;
};

/// `weights.airspeed` is V_0; 0: nothing is scaled. The step is not longer than the Runge-Kutta step of the roll loop
/// allows. With 40 intervals the horizon grows up to V = 4 V_0 for the default roll loop, with more intervals
/// farther.
SpeedScaling scalingAt(double airspeed, const LateralWeights& weights, const HorizonOptions& horizon,
                       const LateralModel& model) noexcept;

/// The weights at that scale, with the largest |e_t| of the horizon [m].
LateralWeights scaledWeights(const LateralWeights& weights, const SpeedScaling& scaling,
                             double largest_error) noexcept;

/// In what a corner is flown.
struct CornerConditions {
  double airspeed = 14.0;                          ///< V [m/s], > 0
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  ///< (north, east) [m/s]
  double roll = 0.6108652381980153;                ///< greatest roll [rad]
  double horizon = 4.0;                            ///< length of the horizon [s]
};

/// `scaled_airspeed` is V_0 [m/s]; 0: the acceptance radius stays.
CornerShape cornerShapeOf(const SwitchGate& gate, const CornerConditions& conditions, double scaled_airspeed,
                          const LateralModel& model) noexcept;

/// Airspeed times this is e_near [s].
constexpr double kNearTime = 0.25;

}  // namespace polyfly
