#pragma once

#include <string>

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
  /// Greatest distance of a position from the expected one [m].
  double jump_distance = 15.0;
  /// Greatest change of heading or roll from the last state, in addition to what turns need [rad].
  double jump_angle = 1.0;
  /// Longest time for which the last horizon is flown without a new one [s].
  double hold_time = 2.0;
};

/// Hysteresis of a limit, as a share of the limit [-].
constexpr double kHysteresis = 0.05;

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
  /// The airspeed that the autopilot holds. Weights and horizon are scaled to it, see speed_scaling.hpp [m/s].
  double airspeed_nominal = 14.0;
  /// Whether the wind follows the difference of ground and air velocity. So the predicted course begins as the measured
  /// one.
  bool corrects_wind = true;
  /// Whether the prediction uses the observer's roll bias, turn gain and turn bias.
  bool learns_disturbance = true;
  /// Whether a turning side is chosen and kept where the path leads back, see reversal.hpp.
  bool chooses_side = true;
  /// Whether L1 guidance takes over from an optimisation that does not lead to the path, see ConvergenceWatch.
  bool falls_back = true;
};

/// Takes this project's additions off the chapter's controller, but for those that are numbers of `weights` and `limits`.
inline void removeAdditions(GuidanceOptions& options) {
  options.weights.feedforward = 0.0;
  options.weights.curvature = 0.0;
  options.criterion.smooth_radius = options.criterion.acceptance_radius;
  options.criterion.at_bisector = false;
  options.corrects_wind = false;
  options.learns_disturbance = false;
  options.chooses_side = false;
  options.falls_back = false;
}

/// The chapter's controller as it was published. launch/config/techpod_published.yaml has the same values.
inline GuidanceOptions publishedGuidance() {
  GuidanceOptions options;
  options.weights = LateralWeights{};
  // Only the roll reference has bounds.
  options.limits.roll = 1.4;
  removeAdditions(options);
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
  visit("safety/jump_distance", safety.jump_distance, "m", Range{0.5, 1000.0});
  visit("safety/jump_angle", safety.jump_angle, "rad", Range{0.1, 10.0});
  visit("safety/hold_time", safety.hold_time, "s", Range{0.0, 60.0, 10.0, 1.0});
}

/// The one list of all options that are set by name, but the loiter's direction.
template <class Options, class Visit>
void visitGuidance(Options& options, Visit&& visit) {
  visitHorizon(options.horizon, visit);
  visitTuning(options.weights, visit);
  visit("weights/airspeed", options.weights.airspeed, "m/s", Range{0.0, 200.0});
  visitLimits(options.limits, visit);
  visitSafety(options.safety, visit);
  visit("model/a0", options.model.a0, "1/s^2", Range{0.1, 1e4});
  visit("model/a1", options.model.a1, "1/s", Range{0.1, 1e3});
  visit("model/b0", options.model.b0, "1/s^2", Range{0.1, 1e4});
  visit("model/roll_rate_max", options.model.roll_rate_max, "rad/s", Range{0.0, 20.0});
  visit("path/acceptance_radius", options.criterion.acceptance_radius, "m", Range{0.1, 1e4});
  visit("path/loiter_radius", options.loiter.radius, "m", Range{1.0, 1e5});
  visit("guidance/period", options.period, "s", Range{0.005, 1.0});
  visit("guidance/airspeed_nominal", options.airspeed_nominal, "m/s", Range{1.0, 200.0});
}

/// Throws Error naming the key, its range and its value, after `where`.
void checkGuidance(const GuidanceOptions& options, const std::string& where);

}  // namespace polyfly
