#include "online_controller/reference/vertical_ramp.hpp"

#include <algorithm>

namespace polyfly {
namespace {

constexpr double kBlend = 1.0;  // until the full speed of a descent [s]

}  // namespace

VerticalRamp VerticalRamp::up(const Reference& start, double time, double height, double duration) noexcept {
  VerticalRamp ramp;
  ramp.start_ = start;
  ramp.time_ = time;
  ramp.height_ = height;
  ramp.duration_ = duration;
  return ramp;
}

VerticalRamp VerticalRamp::down(const Reference& start, double time, double speed) noexcept {
  VerticalRamp ramp;
  ramp.start_ = start;
  ramp.time_ = time;
  ramp.speed_ = speed;
  return ramp;
}

Reference VerticalRamp::at(double time) const noexcept {
  Reference reference;
  reference.position = start_.position;
  reference.yaw = start_.yaw;
  if (duration_ > 0.0) {
    const double s = std::clamp((time - time_) / duration_, 0.0, 1.0);
    const double rate = height_ / duration_;
    reference.position.z() += height_ * s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
    reference.velocity.z() = rate * 30.0 * s * s * (1.0 - s) * (1.0 - s);
    reference.acceleration.z() = rate / duration_ * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s);
    return reference;
  }
  const double elapsed = std::max(time - time_, 0.0);
  const double s = std::min(elapsed / kBlend, 1.0);
  // The speed rises as 3 s^2 - 2 s^3; half of the blend is lost way.
  const double way = kBlend * s * s * s * (1.0 - 0.5 * s) + std::max(elapsed - kBlend, 0.0);
  reference.position.z() -= speed_ * way;
  reference.velocity.z() = -speed_ * s * s * (3.0 - 2.0 * s);
  reference.acceleration.z() = -speed_ / kBlend * 6.0 * s * (1.0 - s);
  return reference;
}

}  // namespace polyfly
