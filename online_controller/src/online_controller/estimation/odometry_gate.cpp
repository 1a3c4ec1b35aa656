#include "online_controller/estimation/odometry_gate.hpp"

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

}  // namespace

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

OdometryGate::Verdict OdometryGate::check(const VehicleState& state) noexcept {
  const ControlReason unusable = !isValid(state)                                ? ControlReason::kNotFinite
                                 : repeat_.repeats(state, options_.repeat_time) ? ControlReason::kStale
                                                                                : ControlReason::kNone;
  if (unusable != ControlReason::kNone) {
    silent_ = true;
    return {unusable};
  }
  ControlReason refusal = started_ ? compare(last_, state) : ControlReason::kNone;
  if (started_ && !silent_ && state.stamp - led_.stamp > kGreatestGap) refusal = ControlReason::kOutOfOrder;
  const bool turned = started_ && hasTurned(led_, state);
  if (turned && refusal == ControlReason::kNone) refusal = ControlReason::kJump;
  Verdict verdict;
  if (refusal != ControlReason::kNone) {
    const bool agrees =
        agreeing_ > 0 && compare(candidate_, state) == ControlReason::kNone && !hasTurned(candidate_, state);
    addCandidate(state, agrees);
    const int wait = options_.hold_periods + (turned ? options_.level_periods : 0);
    if (agreeing_ <= wait || (turned && isElsewhere())) {
      if (state.stamp < led_.stamp || refusal == ControlReason::kOutOfOrder) return {refusal};
      const Eigen::Quaterniond attitude = turned ? ledAttitude(led_, state) : state.attitude;
      led_ = state;
      led_.attitude = attitude;
      return {refusal};
    }
    verdict.restarted = true;
    if (refusal == ControlReason::kOutOfOrder) verdict.time_jump = state.stamp - last_.stamp;
  }
  last_ = led_ = state;
  started_ = true;
  silent_ = false;
  agreeing_ = 0;
  return verdict;
}

}  // namespace polyfly
