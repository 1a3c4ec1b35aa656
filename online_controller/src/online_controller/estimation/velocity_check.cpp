#include "online_controller/estimation/velocity_check.hpp"

#include <algorithm>

namespace polyfly {
namespace {

constexpr double kWindow = 1.0;      // [s]
constexpr double kLongestGap = 0.5;  // [s]
// Distance that an estimator may correct in a window [m].
constexpr double kFreeGap = 0.2;
// Share of the way that an estimator may correct in addition.
constexpr double kFreeShare = 0.3;
constexpr int kWindowsMissed = 2;

}  // namespace

void VelocityCheck::beginWindow(const VehicleState& state) noexcept {
  begin_ = state.stamp;
  from_ = state.position;
  moved_.setZero();
  way_ = 0.0;
}

bool VelocityCheck::contradicts(const VehicleState& state) noexcept {
  const double elapsed = state.stamp - last_.stamp;
  // Written so that NaN begins anew.
  if (!started_ || !(elapsed >= 0.0 && elapsed <= kLongestGap)) {
    restart();
    started_ = true;
    beginWindow(state);
  } else {
    moved_ += 0.5 * elapsed * (last_.velocity + state.velocity);
    way_ += 0.5 * elapsed * (last_.velocity.norm() + state.velocity.norm());
  }
  last_ = state;
  if (state.stamp - begin_ < kWindow) return missed_ >= kWindowsMissed;
  const Eigen::Vector3d went = state.position - from_;
  const double room = kFreeGap + kFreeShare * std::max(way_, went.norm());
  missed_ = (went - moved_).norm() > room ? std::min(missed_ + 1, kWindowsMissed) : 0;
  beginWindow(state);
  return missed_ >= kWindowsMissed;
}

}  // namespace polyfly
