#include "online_controller/odometry_gate.hpp"

#include "online_controller/sane.hpp"

namespace polyfly {
namespace {

constexpr double kGreatestAcceleration = 20.0;  // that a vehicle is granted between two samples [m/s^2]

}  // namespace

ControlReason OdometryGate::compare(const VehicleState& before, const VehicleState& state) const noexcept {
  const double elapsed = state.stamp - before.stamp;
  if (elapsed < 0.0) return ControlReason::kOutOfOrder;
  if (jump_distance_ <= 0.0) return ControlReason::kNone;
  const Eigen::Vector3d explained = 0.5 * elapsed * (before.velocity + state.velocity);
  const double room = jump_distance_ + 0.5 * kGreatestAcceleration * elapsed * elapsed;
  const bool near = (state.position - before.position - explained).norm() <= room;
  return near ? ControlReason::kNone : ControlReason::kJump;
}

OdometryGate::Verdict OdometryGate::check(const VehicleState& state) noexcept {
  if (!isSane(state)) return {ControlReason::kNotFinite, false};
  const ControlReason refusal = started_ ? compare(last_, state) : ControlReason::kNone;
  bool restarted = false;
  if (refusal != ControlReason::kNone) {
    agreeing_ = agreeing_ > 0 && compare(candidate_, state) == ControlReason::kNone ? agreeing_ + 1 : 1;
    candidate_ = state;
    if (agreeing_ <= confirmations_) return {refusal, false};
    restarted = true;
  }
  last_ = state;
  started_ = true;
  agreeing_ = 0;
  return {ControlReason::kNone, restarted};
}

}  // namespace polyfly
