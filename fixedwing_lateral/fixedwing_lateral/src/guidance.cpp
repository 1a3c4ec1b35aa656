#include "fixedwing_lateral/guidance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fixedwing_lateral/l1_guidance.hpp"
#include "fixedwing_lateral/turn_limits.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/range_check.hpp"

namespace polyfly {
namespace {

using Index = LateralIndex;

// Age after which the nodes are too old for a start [s].
constexpr double kHorizonLife = 0.5;
// Roll rate above which the state is not valid [rad/s].
constexpr double kFastest = 20.0;
// Roll above which the model is not valid [rad].
constexpr double kSteepest = 80.0 / 180.0 * kPi;
// Rate of heading and roll that is allowed between two states [rad/s].
constexpr double kTurnRate = 0.5;
// Time after which a new position is accepted [s].
constexpr double kJumpPatience = 0.5;
// Heading rate per heading error in the turn into the wind [1/s].
constexpr double kUpwindGain = 0.6;
// Index of the move that is flown: the second, as published.
constexpr int kAppliedMove = 1;
// Ground speed below which a state may repeat itself [m/s].
constexpr double kStandingSpeed = 1.0;

bool isFinite(const AircraftState& state) noexcept {
  return state.position.allFinite() && state.ground_velocity.allFinite() && std::isfinite(state.heading) &&
         std::isfinite(state.stamp) && std::abs(state.roll_rate) < kFastest &&
         std::abs(state.roll) < kSteepest;
}

}  // namespace

void checkGuidance(const GuidanceOptions& options, const std::string& where) {
  visitGuidance(options, RangeCheck{where});
}

LateralGuidance::LateralGuidance(const GuidanceOptions& options, const std::string& where)
    : options_((checkGuidance(options, where), options)),
      air_(options),
      observer_(options.model),
      scaling_(scalingAt(options.airspeed_nominal, options.weights, options.horizon, options.model)),
      nmpc_(options.model, {options.horizon.horizon, scaling_.step}, where),
      kept_moves_(options.horizon.horizon) {
  setWeights();
}

void LateralGuidance::setMission(Mission mission) {
  track_ = MissionTrack(std::move(mission), options_.criterion);
  beginSegment();
  trustOptimisation();
  needs_restart_ = true;
}

void LateralGuidance::beginSegment() noexcept {
  convergence_.restart();
  reversal_.begin();
}

void LateralGuidance::clearMission() { track_ = MissionTrack(); }

void LateralGuidance::setTuning(const LateralWeights& weights, const LateralLimits& limits,
                                const SafetyOptions& safety) noexcept {
  const double airspeed = options_.weights.airspeed;
  options_.weights = weights;
  options_.weights.airspeed = airspeed;
  options_.limits = limits;
  options_.safety = safety;
  air_.setSafety(safety);
  scaling_ = scalingAt(options_.airspeed_nominal, options_.weights, options_.horizon, options_.model);
  setWeights();
  prepared_ = false;
  trustOptimisation();
}

void LateralGuidance::trustOptimisation() noexcept {
  needs_restart_ = needs_restart_ || falls_back_;
  convergence_.restart();
  falls_back_ = false;
  probation_ = 1.0;
}

void LateralGuidance::shapeCorner() noexcept {
  track_.setNearScale(scaling_.scale * scaling_.scale);
  if (track_.empty()) return;
  const CornerConditions corner{air_.airspeed(), air_.wind(), options_.limits.roll_reference,
                                nmpc_.horizon() * nmpc_.stepDuration()};
  track_.shapeCorner(cornerShapeOf(track_.gate(), corner, options_.weights.airspeed, options_.model));
}

void LateralGuidance::setWeights() noexcept {
  nmpc_.setTuning(scaledWeights(options_.weights, scaling_, nmpc_.largestTrackError()), options_.limits);
}

const GuidanceOutput& LateralGuidance::update(const GuidanceInput& input) noexcept {
  output_.restarted = false;
  output_.nmpc = NmpcReport{};
  const GuidanceReason bad = fault(input);
  if (bad != GuidanceReason::kNone) {
    observer_.interrupt();
    output_.reason = bad;
    holdOrLevel(input.time);
    return output_;
  }
  const AircraftState& state = input.state;
  air_.update(input.time, input.airspeed, input.wind, state.ground_velocity, state.heading);
  output_.airspeed = air_.airspeed();
  output_.wind = air_.wind();
  const double elapsed = std::max(0.0, input.time - last_time_);
  last_time_ = input.time;
  learn(input);
  shapeCorner();
  if (track_.advance(state.position, state.ground_velocity, falls_back_)) {
    nmpc_.clearSwitch();
    beginSegment();
    shapeCorner();
    prepared_ = false;
  }
  output_.segment = track_.index();
  output_.segment_count = track_.count();
  output_.loitering = track_.isLoitering();
  checkSegment(state);
  watchConvergence(state, input.engaged ? elapsed : std::numeric_limits<double>::infinity());

  if (!input.engaged) {
    needs_restart_ = true;
    const double limit = options_.limits.roll_reference;
    command(GuidanceMode::kStandby, GuidanceReason::kNotEngaged, std::clamp(state.roll, -limit, limit));
  } else if (track_.empty()) {
    needs_restart_ = true;
    command(GuidanceMode::kLevel, GuidanceReason::kNoMission, 0.0);
  } else if (air_.isSlow()) {
    needs_restart_ = true;
    command(GuidanceMode::kLevel, GuidanceReason::kLowAirspeed, 0.0);
  } else if (air_.isWindy()) {
    needs_restart_ = true;
    command(GuidanceMode::kUpwind, GuidanceReason::kStrongWind, upwindReference(state.heading));
  } else if (falls_back_) {
    needs_restart_ = true;
    command(GuidanceMode::kFallback, GuidanceReason::kNotConverging, fallbackReference(state));
    std::fill(kept_moves_.begin(), kept_moves_.end(), output_.roll_reference);
    horizon_time_ = input.time;
  } else if (solve(input)) {
    keepHorizon(input.time);
    const GuidanceReason reason = air_.airspeedAssumed() ? GuidanceReason::kAirspeedAssumed
                                  : air_.windAssumed()   ? GuidanceReason::kWindAssumed
                                  : too_steep_           ? GuidanceReason::kTooSteep
                                                         : GuidanceReason::kNone;
    command(GuidanceMode::kTracking, reason, nmpc_.moves()[kAppliedMove]);
  } else {
    needs_restart_ = true;
    output_.reason = GuidanceReason::kSolver;
    holdOrLevel(input.time);
  }
  return output_;
}

void LateralGuidance::prepare() noexcept {
  if (needs_restart_ || track_.empty()) return;
  nmpc_.keepAsPrevious(options_.period / nmpc_.stepDuration());
  fillData();
  prepared_ = nmpc_.prepare(data_);
}

GuidanceReason LateralGuidance::fault(const GuidanceInput& input) noexcept {
  const AircraftState& state = input.state;
  if (!isFinite(state) || !std::isfinite(input.time)) return GuidanceReason::kNotFinite;
  if (std::abs(input.time - state.stamp) > options_.safety.state_timeout || repeats(state))
    return GuidanceReason::kStale;
  return hasJumped(state) ? GuidanceReason::kJump : GuidanceReason::kNone;
}

// What moves is not for long where it was, whatever the stamp says.
bool LateralGuidance::repeats(const AircraftState& state) noexcept {
  if (state.position != seen_.position || state.stamp < seen_.stamp) seen_ = state;
  return state.ground_velocity.norm() > kStandingSpeed &&
         state.stamp - seen_.stamp > options_.safety.state_timeout;
}

// Whether heading or roll is another one than the last, with the room that turns and the roll rates need.
bool LateralGuidance::hasTurned(const AircraftState& state, double elapsed) const noexcept {
  const double room = options_.safety.jump_angle;
  const double roll = place_.roll + 0.5 * elapsed * (place_.roll_rate + state.roll_rate);
  return std::abs(wrapCourse(state.heading - place_.heading)) > room + kTurnRate * elapsed ||
         std::abs(state.roll - roll) > room + kTurnRate * elapsed;
}

// A position is expected where the last velocity leads. One that is not is believed after a while, as is one
// after a pause too long to expect anything. Another heading would be flown by in the wrong direction, where
// the last horizon goes on as it was; so heading and roll are believed after that pause only.
bool LateralGuidance::hasJumped(const AircraftState& state) noexcept {
  const SafetyOptions& safety = options_.safety;
  const double elapsed = state.stamp - place_.stamp;
  if (has_place_ && elapsed >= 0.0 && elapsed <= safety.hold_time) {
    const Eigen::Vector2d expected =
        place_.position + 0.5 * elapsed * (place_.ground_velocity + state.ground_velocity);
    const bool turned = hasTurned(state, elapsed);
    if (turned || (state.position - expected).norm() > safety.jump_distance) {
      if (!jumping_) jump_since_ = state.stamp;
      jumping_ = true;
      if (turned || state.stamp - jump_since_ < kJumpPatience) return true;
    }
  }
  needs_restart_ = needs_restart_ || jumping_;
  jumping_ = false;
  has_place_ = true;
  place_ = state;
  return false;
}

bool LateralGuidance::solve(const GuidanceInput& input) noexcept {
  LateralState state;
  state << input.state.position.x(), input.state.position.y(), input.state.roll, input.state.heading,
      input.state.roll_rate, 0.0;
  const double age = input.time - horizon_time_;
  if (needs_restart_ || !(age >= 0.0 && age <= kHorizonLife)) restart(state);
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (!prepared_) {
      fillData();
      prepared_ = nmpc_.prepare(data_);
    }
    prepared_ = false;
    output_.nmpc = nmpc_.feedback(state);
    if (output_.nmpc.hasMoves()) return true;
    restart(state);
  }
  return false;
}

// All but the gate.
LateralConditions LateralGuidance::presentConditions() const noexcept {
  LateralConditions conditions;
  conditions.airspeed = air_.airspeed();
  conditions.wind = air_.wind();
  conditions.roll_bias = output_.roll_bias;
  conditions.turn_gain = output_.turn_gain;
  conditions.turn_bias = output_.turn_bias;
  return conditions;
}

// How far off the segment is, and whether it can be flown: a reason that comes and goes with each gust says
// nothing.
void LateralGuidance::checkSegment(const AircraftState& state) noexcept {
  output_.segment_roll = 0.0;
  output_.error = TrackError{};
  if (!track_.empty()) {
    const PathPoint nearest = closestPoint(track_.current(), state.position).point;
    output_.error = trackError(nearest, state.position, state.ground_velocity);
    chooseReversal(state);
    const LateralConditions conditions = presentConditions();
    output_.segment_roll = steepestRoll(track_.current(), state.position, conditions);
  }
  const double limit = options_.limits.roll_reference;
  too_steep_ = output_.segment_roll > limit * (too_steep_ ? 1.0 - kHysteresis : 1.0);
}

// By the error that the optimisation sees.
void LateralGuidance::chooseReversal(const AircraftState& state) noexcept {
  if (!options_.chooses_side) return;
  const PathPoint nearest = closestOnCarrier(track_.current(), state.position).point;
  const TrackError error = trackError(nearest, state.position, state.ground_velocity);
  const Reversal before = reversal_.chosen();
  reversal_.update(error, nearest.position - state.position, state.ground_velocity, air_.wind());
  if (reversal_.chosen() != before) prepared_ = false;
}

// From the reference of the call before, if the autopilot followed it.
void LateralGuidance::learn(const GuidanceInput& input) noexcept {
  if (!options_.learns_disturbance) return;
  if (output_.mode == GuidanceMode::kStandby || !input.engaged || air_.airspeedAssumed())
    observer_.interrupt();
  observer_.update(input.state, air_.airspeed(), output_.roll_reference);
  output_.roll_bias = observer_.rollBias();
  output_.turn_gain = observer_.turnGain();
  output_.turn_bias = observer_.turnBias();
}

void LateralGuidance::fillData() noexcept {
  data_.conditions = presentConditions();
  data_.conditions.gate = track_.gate();
  data_.current = track_.current();
  data_.next = track_.shownNext();
  data_.reversal = reversal_.chosen();
  if (scaling_.scale > 1.0) setWeights();
  data_.next_reversal = &track_.shownNext() == &track_.current() ? data_.reversal : Reversal::kNone;
}

void LateralGuidance::restart(const LateralState& state) noexcept {
  fillData();
  nmpc_.reset(data_, state, state[Index::kRoll]);
  needs_restart_ = prepared_ = false;
  output_.restarted = true;
}

void LateralGuidance::keepHorizon(double time) noexcept {
  std::copy(nmpc_.moves(), nmpc_.moves() + nmpc_.horizon(), kept_moves_.begin());
  horizon_time_ = time;
}

void LateralGuidance::holdOrLevel(double time) noexcept {
  const double since = time - horizon_time_;
  if (since >= 0.0 && since <= options_.safety.hold_time) {
    const int later = kAppliedMove + static_cast<int>(since / nmpc_.stepDuration());
    if (later < nmpc_.horizon()) {
      command(GuidanceMode::kHoldHorizon, output_.reason, kept_moves_[later]);
      return;
    }
  }
  command(GuidanceMode::kLevel, output_.reason, 0.0);
}

// A segment that cannot be flown is not left by a fault of the optimisation. After a pause, or another pilot, the aircraft
// may be anywhere, so the comparison begins anew.
void LateralGuidance::watchConvergence(const AircraftState& state, double elapsed) noexcept {
  if (!options_.falls_back || track_.empty() || too_steep_ || air_.isSlow() || air_.isWindy() ||
      elapsed > kHorizonLife) {
    convergence_.restart();
    return;
  }
  convergence_.update(output_.error, state.ground_velocity.norm(), options_.limits.roll_reference, elapsed);
  if (!falls_back_ && convergence_.withoutProgress() > 1.0) {
    falls_back_ = true;
  } else if (falls_back_ && convergence_.near() > probation_) {
    falls_back_ = false;
    probation_ *= 2.0;
    convergence_.restart();
  }
}

double LateralGuidance::fallbackReference(const AircraftState& state) const noexcept {
  L1Options l1;
  l1.roll_limit = options_.limits.roll_reference;
  l1.period = std::max(l1.period, leastL1Period(air_.airspeed(), l1));
  return l1RollReference(track_.current(), state.position, state.ground_velocity, l1);
}

// Towards the heading against the wind, by a coordinated turn at a rate in proportion.
double LateralGuidance::upwindReference(double heading) const noexcept {
  const double against = std::atan2(-air_.wind().y(), -air_.wind().x());
  const double rate = kUpwindGain * wrapCourse(against - heading);
  const double limit = options_.limits.roll_reference;
  return std::clamp(std::atan(air_.airspeed() * rate / kGravity), -limit, limit);
}

void LateralGuidance::command(GuidanceMode mode, GuidanceReason reason, double roll_reference) noexcept {
  output_.mode = mode;
  output_.reason = reason;
  const double limit = options_.limits.roll_reference;
  output_.roll_reference = std::isfinite(roll_reference) ? std::clamp(roll_reference, -limit, limit) : 0.0;
}

}  // namespace polyfly
