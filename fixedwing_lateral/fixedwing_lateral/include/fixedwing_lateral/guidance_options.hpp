#pragma once

#include <string>

#include "fixedwing_lateral/convergence.hpp"
#include "fixedwing_lateral/mission.hpp"
#include "fixedwing_lateral/model.hpp"
#include "fixedwing_lateral/tuning.hpp"

namespace polyfly {

/// When data are too old or too odd to fly by, and what then.
struct SafetyOptions {
  /// Greatest age of the state [s].
  double state_timeout = 0.3;
  /// Greatest age of the airspeed; after it the nominal airspeed is assumed [s].
  double airspeed_timeout = 1.0;
  /// Greatest age of the wind; after it the difference of ground and air velocity is assumed [s].
  double wind_timeout = 5.0;
  /// Least airspeed; below it the wings are levelled [m/s].
  double airspeed_min = 8.0;
  /// Greatest wind speed as a share of the airspeed; above it the aircraft turns into the wind [-].
  double wind_share_max = 0.85;
  /// Hysteresis of a limit, as a share of the limit [-].
  double hysteresis = 0.05;
  /// Greatest distance of a position from the expected one [m].
  double jump_distance = 15.0;
  /// Greatest change of heading or roll from the last state, in addition to what turns need [rad].
  double jump_angle = 1.0;
  /// Time after which a new position is accepted [s].
  double jump_patience = 0.5;
  /// Longest time for which the last horizon is flown without a new one [s].
  double hold_time = 2.0;
  /// Heading rate per heading error in the turn into the wind [1/s].
  double upwind_gain = 0.6;
  /// When L1 guidance takes over from an optimisation that does not lead to the path.
  ConvergenceOptions convergence;
};

/// The weights that are flown by default: as published, with this project's additions. e_t counts three times as much as
/// published: the path is met sooner and left less in wind and gusts, for a little more roll.
inline LateralWeights defaultWeights() {
  LateralWeights weights;
  weights.track = 0.03;
  weights.feedforward = 1.0;
  weights.curvature = 1.0;
  weights.airspeed = 14.0;
  return weights;
}

/// When a segment counts as flown by default: a corner at its bisector. So the horizon sees of each place the error from the
/// nearer segment. A corner is then cut no farther on the inside than it is passed on the outside.
inline SwitchCriterion defaultCriterion() {
  SwitchCriterion criterion;
  criterion.at_bisector = true;
  return criterion;
}

struct GuidanceOptions {
  HorizonOptions horizon;
  LateralWeights weights = defaultWeights();
  LateralLimits limits;
  LateralModel model;
  SwitchCriterion criterion = defaultCriterion();
  LoiterOptions loiter;
  SafetyOptions safety;
  /// Time between two calls [s].
  double period = 0.05;
  double airspeed_nominal = 14.0;  ///< [m/s]
  /// Time in which the wind follows the difference of ground and air velocity. So the predicted course begins
  /// as the measured one. 0: not at all [s].
  double wind_correction_time = 0.3;
  /// Whether the prediction uses the observer's roll bias, turn gain and turn bias.
  bool learn_disturbance = true;
  /// Gain of the turn rate by roll before any was learnt: the `turn_gain` of an earlier flight's status [-].
  double turn_gain = 1.0;
  /// Whether a turning side is chosen and kept where the path leads back, see reversal.hpp.
  bool choose_side = true;
  /// Index of the move that is sent: 1 as published, or 0 with `delay`.
  int applied_move = 1;
  /// Time from the state to the effect of the command; the state is predicted over it [s].
  double delay = 0.0;
  /// Greatest number of iterations in one call.
  int iterations = 1;
  /// KKT measure below which the iterations stop.
  double kkt_tolerance = 1e-3;
};

/// The chapter's controller as it was published: none of this project's additions. launch/config/techpod_published.yaml
/// has the same values.
inline GuidanceOptions publishedGuidance() {
  GuidanceOptions options;
  options.weights = LateralWeights{};
  // Only the roll reference has bounds.
  options.limits.roll = 1.4;
  options.criterion.smooth_radius = options.criterion.acceptance_radius;
  options.criterion.at_bisector = false;
  options.wind_correction_time = 0.0;
  options.learn_disturbance = false;
  options.choose_side = false;
  options.safety.convergence.turns = 0.0;
  return options;
}

/// The one list of what a running guidance may change.
template <class Options, class Visit>
void visitSafety(Options& safety, Visit&& visit) {
  visit("safety/state_timeout", safety.state_timeout, "s", Range{0.01, 10.0});
  visit("safety/airspeed_timeout", safety.airspeed_timeout, "s", Range{0.01, 60.0});
  visit("safety/wind_timeout", safety.wind_timeout, "s", Range{0.01, 600.0});
  visit("safety/airspeed_min", safety.airspeed_min, "m/s", Range{1.0, 100.0});
  visit("safety/wind_share_max", safety.wind_share_max, "", Range{0.1, 0.99});
  visit("safety/hysteresis", safety.hysteresis, "", anyChange(0.0, 0.5));
  visit("safety/jump_distance", safety.jump_distance, "m", Range{0.5, 1000.0});
  visit("safety/jump_angle", safety.jump_angle, "rad", Range{0.1, 10.0});
  visit("safety/jump_patience", safety.jump_patience, "s", Range{0.0, 60.0, 10.0, 1.0});
  visit("safety/hold_time", safety.hold_time, "s", Range{0.0, 60.0, 10.0, 1.0});
  visit("safety/upwind_gain", safety.upwind_gain, "1/s", Range{0.01, 5.0});
  visit("safety/convergence_time", safety.convergence.near_time, "s", Range{0.05, 10.0});
  visit("safety/convergence_turns", safety.convergence.turns, "", Range{0.0, 100.0, 10.0, 1.0});
}

/// The one list of all options but the loiter's direction.
template <class Options, class Visit>
void visitGuidance(Options& options, Visit&& visit) {
  visitHorizon(options.horizon, visit);
  visitTuning(options.weights, visit);
  visitLimits(options.limits, visit);
  visitSafety(options.safety, visit);
  visit("model/a0", options.model.a0, "1/s^2", Range{0.1, 1e4});
  visit("model/a1", options.model.a1, "1/s", Range{0.1, 1e3});
  visit("model/b0", options.model.b0, "1/s^2", Range{0.1, 1e4});
  visit("model/gravity", options.model.gravity, "m/s^2", Range{1.0, 30.0});
  visit("model/roll_rate_max", options.model.roll_rate_max, "rad/s", Range{0.0, 20.0});
  visit("model/switch_rate", options.model.switch_rate, "1/s", Range{1e-3, 1e3});
  visit("model/switch_threshold", options.model.switch_threshold, "", Range{1e-6, 1e3});
  visit("path/acceptance_radius", options.criterion.acceptance_radius, "m", Range{0.1, 1e4});
  visit("path/smooth_radius", options.criterion.smooth_radius, "m", Range{0.1, 1e4});
  visit("path/course_tolerance", options.criterion.course_tolerance, "rad", Range{0.01, 3.14});
  visit("path/switch_at_bisector", options.criterion.at_bisector);
  visit("path/choose_side", options.choose_side);
  visit("path/loiter_radius", options.loiter.radius, "m", Range{1.0, 1e5});
  visit("guidance/period", options.period, "s", Range{0.005, 1.0});
  visit("guidance/airspeed_nominal", options.airspeed_nominal, "m/s", Range{1.0, 200.0});
  visit("guidance/wind_correction_time", options.wind_correction_time, "s", Range{0.0, 60.0});
  visit("guidance/learn_disturbance", options.learn_disturbance);
  visit("guidance/turn_gain", options.turn_gain, "", Range{0.7, 1.3});
  visit("guidance/applied_move", options.applied_move, "", Range{0.0, 1.0});
  visit("guidance/delay", options.delay, "s", Range{0.0, 1.0});
  visit("guidance/iterations", options.iterations, "", Range{1.0, 100.0});
  visit("guidance/kkt_tolerance", options.kkt_tolerance, "", Range{1e-12, 1e3});
}

/// Throws Error naming the key, its range and its value, after `where`.
void checkGuidance(const GuidanceOptions& options, const std::string& where);

}  // namespace polyfly
