#include "online_controller/estimation/odometry_gate.hpp"

#include <algorithm>
#include <cmath>

#include "online_controller/types/valid.hpp"

namespace polyfly {
namespace {

// Greatest acceleration of a vehicle between two samples [m/s^2].
constexpr double kGreatestAcceleration = 20.0;
// Greatest angular acceleration, beyond what the vehicle's rates say [rad/s^2].
constexpr double kGreatestAngularAcceleration = 20.0;
// Longest time between two samples without a silence [s].
constexpr double kGreatestGap = 1.0;
// Least velocity difference that shows positions and velocities of different frames [m/s].
constexpr double kOtherWay = 0.2;
// Times within which what the rates led to is forgotten [s].
constexpr double kShortMemory = 5.0;
constexpr double kLongMemory = 60.0;
// Tilt by which rates that fit the attitude do not err [rad].
constexpr double kOtherTilt = 0.5;
// Longest time for which the attitude is that of the rates [s].
constexpr double kLedTime = 10.0;
// Speed above which a vehicle's velocity tells whether the frame turned [m/s].
constexpr double kTellingSpeed = 0.5;
// Greatest rate of a vehicle [rad/s].
constexpr double kGreatestRate = 20.0;
// Longest time between two samples over which rates and velocities are integrated [s].
constexpr double kLongestGap = 0.5;
// Time within which a way that velocities do not explain is forgotten [s].
constexpr double kWayMemory = 1.0;
// Such a way that an estimator may correct [m], and as a share of the whole way.
constexpr double kFreeWay = 0.2;
constexpr double kFreeShare = 0.2;
// Greatest share of kFreeWay that one correction of the position may be [m/s, s].
constexpr double kGreatestDifference = 4.0;
constexpr double kCorrectionTime = 0.05;
// Bandwidth of the velocity from positions, critically damped [1/s].
constexpr double kWayBandwidth = 12.0;
constexpr double kPi = 3.14159265358979323846;

// Where the body rates of both samples lead from the attitude of the first one.
Eigen::Quaterniond ledAttitude(const VehicleState& before, const VehicleState& state) noexcept {
  const Eigen::Vector3d turn =
      0.5 * (state.stamp - before.stamp) * (before.angular_velocity + state.angular_velocity);
  const double angle = turn.norm();
  // Odometry may have no rates. Written so that NaN turns nothing.
  if (!(angle > 0.0 && std::isfinite(angle))) return before.attitude;
  return (before.attitude * Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle))).normalized();
}

// Of half the angle between two attitudes; q and -q are the same one.
double halfCosine(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) noexcept {
  return std::abs(a.dot(b)) / (a.norm() * b.norm());
}

double angleBetween(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) noexcept {
  return 2.0 * std::acos(std::min(1.0, halfCosine(a, b)));
}

// Where up is in the body: the tilt, whatever the heading.
Eigen::Vector3d upInBody(const Eigen::Quaterniond& attitude) noexcept {
  return attitude.normalized().conjugate() * Eigen::Vector3d::UnitZ();
}

bool hasRates(const VehicleState& state) noexcept {
  const double rate = state.angular_velocity.norm();
  return std::isfinite(rate) && rate > 0.0;
}

}  // namespace

void OdometryGate::Way::begin(const VehicleState& state) noexcept {
  *this = Way{};
  position = state.position;
  velocity = state.velocity;
}

void OdometryGate::Way::add(const VehicleState& before, const VehicleState& state) noexcept {
  const double elapsed = state.stamp - before.stamp;
  if (elapsed > kLongestGap) return begin(state);
  if (elapsed <= 0.0) return;
  const double pole = std::exp(-kWayBandwidth * elapsed);
  const Eigen::Vector3d error = state.position - position - elapsed * velocity;
  position = state.position - pole * pole * error;
  velocity += (1.0 - pole) * (1.0 - pole) / elapsed * error;
  const double kept = std::exp(-elapsed / kWayMemory);
  Eigen::Vector3d missing =
      state.position - before.position - 0.5 * elapsed * (before.velocity + state.velocity);
  const double most = kGreatestDifference * std::min(elapsed, kCorrectionTime);
  if (missing.norm() > most) missing *= most / missing.norm();
  unexplained = kept * unexplained + missing;
  length = kept * length + elapsed * std::max(velocity.norm(), state.velocity.norm());
  // It must agree better to be believed again.
  const double room = (contradicts ? 0.5 : 1.0) * (kFreeWay + kFreeShare * length);
  contradicts = unexplained.norm() > room;
}

void OdometryGate::Memory::lead(const VehicleState& before, const VehicleState& state) noexcept {
  const double elapsed = state.stamp - before.stamp;
  trusted = trusted && fits && hasRates(before) && hasRates(state) && elapsed <= kLongestGap;
  for (Eigen::Quaterniond* attitude : {&led, &long_led}) {
    VehicleState from = before;
    from.attitude = *attitude;
    *attitude = ledAttitude(from, state);
  }
}

// Rates of another unit or frame lead the tilt away while that of the attitude stays.
void OdometryGate::Memory::judgeRates(const VehicleState& state) noexcept {
  const Eigen::Vector3d now = upInBody(state.attitude);
  const double most = std::cos(kOtherTilt);
  const bool stays = now.dot(up) > most * up.norm();
  if (state.angular_velocity.norm() > kGreatestRate || (stays && upInBody(led).dot(now) < most))
    fits = trusted = false;
}

void OdometryGate::Memory::begin(const Eigen::Quaterniond& attitude) noexcept {
  led = attitude.normalized();
  up = upInBody(attitude);
}

void OdometryGate::Memory::draw(const Eigen::Quaterniond& attitude, double elapsed) noexcept {
  const double share = std::min(1.0, elapsed / kShortMemory);
  led = led.slerp(share, attitude).normalized();
  up += share * (upInBody(attitude) - up);
  long_led = long_led.slerp(std::min(1.0, elapsed / kLongMemory), attitude).normalized();
}

ControlReason OdometryGate::compare(const VehicleState& before, const VehicleState& state) const noexcept {
  const double elapsed = state.stamp - before.stamp;
  if (elapsed < 0.0) return ControlReason::kOutOfOrder;
  if (options_.jump_distance <= 0.0) return ControlReason::kNone;
  const Eigen::Vector3d explained = 0.5 * elapsed * (before.velocity + state.velocity);
  const double room = options_.jump_distance + 0.5 * kGreatestAcceleration * elapsed * elapsed;
  const bool near = (state.position - before.position - explained).norm() <= room;
  return near ? ControlReason::kNone : ControlReason::kJump;
}

// An attitude that has stayed is none that jumped, whatever the rates say: theirs may be another unit.
bool OdometryGate::hasTurned(const VehicleState& before, const VehicleState& state) const noexcept {
  const double elapsed = state.stamp - before.stamp;
  const double room = options_.jump_angle + 0.5 * kGreatestAngularAcceleration * elapsed * elapsed;
  const bool any = options_.jump_distance <= 0.0 || options_.jump_angle <= 0.0;
  if (any || elapsed < 0.0 || room >= kPi) return false;
  const double least = std::cos(0.5 * room);
  return halfCosine(before.attitude, state.attitude) < least &&
         halfCosine(ledAttitude(before, state), state.attitude) < least;
}

// Turned from where the rates led it over a longer time. The vehicle itself may have turned back meanwhile.
bool OdometryGate::hasCrept(const VehicleState& state) const noexcept {
  if (!memory_.trusted || options_.jump_distance <= 0.0 || options_.jump_angle <= 0.0) return false;
  return angleBetween(memory_.led, state.attitude) > options_.jump_angle;
}

bool OdometryGate::isLedTo(const VehicleState& state) const noexcept {
  return memory_.fits && hasRates(led_) && hasRates(state) &&
         angleBetween(memory_.long_led, state.attitude) <= 0.5 * options_.jump_angle;
}

// Odometry of 20 Hz that is published at 100 Hz may keep its stamp for a while.
bool OdometryGate::standsStill(double stamp) noexcept {
  same_stamp_ = started_ && stamp == stamp_ ? std::min(same_stamp_ + 1, options_.hold_periods + 1) : 0;
  stamp_ = stamp;
  return options_.repeat_time > 0.0 && same_stamp_ > options_.hold_periods;
}

void OdometryGate::addCandidate(const VehicleState& state, bool agrees) noexcept {
  if (agrees) {
    ++agreeing_;
    candidate_way_ += 0.5 * (state.stamp - candidate_.stamp) * (candidate_.velocity + state.velocity);
  } else {
    agreeing_ = 1;
    candidate_way_.setZero();
    first_candidate_ = state;
  }
  candidate_ = state;
}

// Whether the candidates went elsewhere than their velocities lead.
bool OdometryGate::isElsewhere() const noexcept {
  const Eigen::Vector3d went = candidate_.position - first_candidate_.position;
  return (went - candidate_way_).norm() > kOtherWay * (candidate_.stamp - first_candidate_.stamp);
}

void OdometryGate::accept(const VehicleState& state, bool restarted, bool attitude_restarted) noexcept {
  const double elapsed = std::max(0.0, state.stamp - led_.stamp);
  if (!started_ || restarted) {
    way_.begin(state);
  } else {
    way_.add(last_, state);
  }
  if (!started_) memory_.long_led = state.attitude;
  if (!started_ || restarted || elapsed > kLongestGap || !hasRates(state)) memory_.begin(state.attitude);
  if (attitude_restarted) {
    memory_.trusted = false;
  } else if (memory_.fits && hasRates(state) &&
             angleBetween(memory_.long_led, state.attitude) <= 0.5 * options_.jump_angle) {
    memory_.trusted = true;
  }
  memory_.draw(state.attitude, elapsed);
  last_ = led_ = state;
  started_ = true;
  silent_ = false;
  agreeing_ = 0;
}

ControlReason OdometryGate::unusable(const VehicleState& state) noexcept {
  if (!isValid(state)) return ControlReason::kNotFinite;
  const bool still = standsStill(state.stamp);
  return repeat_.repeats(state, options_.repeat_time) || still ? ControlReason::kStale : ControlReason::kNone;
}

// A frame that turns would turn the velocity of a vehicle that moves.
void OdometryGate::startLed(const VehicleState& state) noexcept {
  const double speed = state.velocity.norm();
  frame_stays_ = speed > kTellingSpeed && (state.velocity - last_.velocity).norm() < 0.5 * speed;
  led_since_ = state.stamp;
}

OdometryGate::Verdict OdometryGate::flyLed(VehicleState& state) noexcept {
  state.attitude = memory_.led;
  const bool contradicted = way_.contradicts;
  way_.add(last_, state);
  const bool changed = way_.contradicts != contradicted;
  last_ = led_ = state;
  if (way_.contradicts) state.velocity = way_.velocity;
  silent_ = false;
  Verdict verdict;
  verdict.restarted = changed;
  verdict.contradicts = true;
  return verdict;
}

OdometryGate::Verdict OdometryGate::check(VehicleState& state) noexcept {
  Verdict verdict;
  verdict.refusal = unusable(state);
  if (verdict.refusal != ControlReason::kNone) {
    silent_ = true;
    return verdict;
  }
  const bool ahead = started_ && !silent_ && state.stamp - led_.stamp > kGreatestGap;
  const bool later = started_ && !ahead && state.stamp >= led_.stamp;
  if (later) {
    memory_.lead(led_, state);
    memory_.judgeRates(state);
  }
  ControlReason refusal = started_ ? compare(last_, state) : ControlReason::kNone;
  if (ahead) refusal = ControlReason::kOutOfOrder;
  const bool jumped = started_ && (hasTurned(led_, state) || (later && hasCrept(state)));
  const bool returned = jumped && later && isLedTo(state);
  const bool turned = jumped && !returned;
  if (!turned) frame_stays_ = false;
  if (turned && memory_.trusted && later && refusal == ControlReason::kNone) {
    if (agreeing_ == 0 && !frame_stays_) startLed(state);
    if (frame_stays_ && state.stamp - led_since_ <= kLedTime) return flyLed(state);
  }
  if (turned && refusal == ControlReason::kNone) refusal = ControlReason::kJump;
  verdict.restarted = returned;
  if (refusal != ControlReason::kNone) {
    const bool agrees =
        agreeing_ > 0 && compare(candidate_, state) == ControlReason::kNone && !hasTurned(candidate_, state);
    addCandidate(state, agrees);
    const int wait = options_.hold_periods + (turned ? options_.level_periods : 0);
    if (agreeing_ <= wait || (turned && isElsewhere())) {
      verdict.restarted = false;
      verdict.refusal = refusal;
      if (!later) return verdict;
      const Eigen::Quaterniond attitude = !turned           ? state.attitude
                                          : memory_.trusted ? memory_.led
                                                            : ledAttitude(led_, state);
      led_ = state;
      led_.attitude = attitude;
      return verdict;
    }
    verdict.restarted = true;
    if (refusal == ControlReason::kOutOfOrder) verdict.time_jump = state.stamp - last_.stamp;
  }
  const bool contradicted = way_.contradicts;
  accept(state, verdict.restarted, turned);
  verdict.restarted = verdict.restarted || way_.contradicts != contradicted;
  verdict.contradicts = way_.contradicts;
  if (way_.contradicts) state.velocity = way_.velocity;
  return verdict;
}

ControlReport byPositions(ControlReport report) noexcept {
  if (!isAnswer(report.status)) return report;
  if (report.status == ControlStatus::kOptimal) report.status = ControlStatus::kSuboptimal;
  report.reason = ControlReason::kContradiction;
  return report;
}

}  // namespace polyfly
