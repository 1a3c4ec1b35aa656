#pragma once

#include <string>

#include "polyfly_base/range.hpp"

namespace polyfly {

/// Eq. 46, diagonal: Q_y = P over (e_t, e_chi, phi, p), and phi_r. As published.
struct LateralWeights {
  /// Weight of the cross-track error e_t [1/m^2].
  double track = 0.01;
  /// Weight of the course error e_chi [1/rad^2].
  double course = 10.0;
  /// Weight of the roll phi [1/rad^2].
  double roll = 0.1;
  /// Weight of the roll rate p [s^2/rad^2].
  double roll_rate = 0.01;
  /// Weight of the roll reference phi_r [1/rad^2].
  double roll_reference = 10.0;
  /// Weight of the change of phi_r from the previous horizon; it falls with (1 - k/N)^2 [1/rad^2].
  double slew = 100.0;
  /// Share of the roll that the path's curvature asks for in this wind, from which phi and phi_r are counted,
  /// taken at the nodes. 0 as published: then a circle is flown a little outside, for the roll's sake.
  double feedforward = 0.0;
  /// Share of the curvature of the motion (position by heading) in the quadratic program's Hessian, where it is
  /// convex. 0 as published: Gauss-Newton. Farther from a path than the horizon reaches, its steps overshoot, and the
  /// roll reference jumps from bound to bound at each call. On the path there is no difference.
  double curvature = 0.0;
  /// Airspeed that the weights and the horizon's length belong to; above it they are scaled, see
  /// speed_scaling.hpp. 0 as published: they are never scaled [m/s].
  double airspeed = 0.0;
};

struct LateralLimits {
  /// Bound of |phi_r|, 35 degrees [rad].
  double roll_reference = 0.6108652381980153;
  /// Bound of |phi|, 45 degrees; relaxed where it cannot be held [rad].
  double roll = 0.7853981633974483;
};

/// What the horizon is over.
struct HorizonOptions {
  int horizon = 40;  ///< N
  /// Step of the prediction [s].
  double step = 0.1;
};

/// The one list of the options that a running guidance may change, see online_controller/types/options.hpp.
template <class Options, class Visit>
void visitTuning(Options& weights, Visit&& visit) {
  visit("weights/track", weights.track, "1/m^2", Range{0.0, 1e3, 10.0, 1.0});
  visit("weights/course", weights.course, "1/rad^2", Range{0.0, 1e5, 10.0, 1.0});
  visit("weights/roll", weights.roll, "1/rad^2", Range{0.0, 1e5, 10.0, 1.0});
  visit("weights/roll_rate", weights.roll_rate, "s^2/rad^2", Range{0.0, 1e5, 10.0, 1.0});
  visit("weights/roll_reference", weights.roll_reference, "1/rad^2", Range{1e-3, 1e5});
  visit("weights/slew", weights.slew, "1/rad^2", Range{0.0, 1e6, 10.0, 1.0});
}

template <class Limits, class Visit>
void visitLimits(Limits& limits, Visit&& visit) {
  visit("limits/roll_reference", limits.roll_reference, "rad", Range{0.05, 1.2});
  visit("limits/roll", limits.roll, "rad", Range{0.05, 1.4});
}

template <class Options, class Visit>
void visitHorizon(Options& options, Visit&& visit) {
  visit("horizon/intervals", options.horizon, "", Range{2.0, 400.0});
  visit("horizon/step", options.step, "s", Range{0.01, 1.0});
}

/// Throw Error naming the key, its range and its value, after `where`.
void checkTuning(const LateralWeights& weights, const LateralLimits& limits, const std::string& where);
void checkHorizon(const HorizonOptions& options, const std::string& where);

}  // namespace polyfly
