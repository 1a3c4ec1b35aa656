#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "online_controller/types/types.hpp"

namespace polyfly {

using Path = std::function<Reference(double)>;

/// A circle with a climb, from rest to `speed` within 5 s.
inline Path helix(double radius, double speed, double climb) {
  return [=](double time) {
    constexpr double kRamp = 5.0;
    const double x = std::clamp(time / kRamp, 0.0, 1.0), w0 = speed / radius;
    const double phase = kRamp * x * x * x * x * (2.5 - 3.0 * x + x * x) + std::max(0.0, time - kRamp);
    const double rate = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
    const double w = w0 * rate, a = w0 * 30.0 * x * x * (1.0 - x) * (1.0 - x) / kRamp;
    const double j = w0 * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (kRamp * kRamp);
    const Eigen::Vector3d out(std::cos(w0 * phase), std::sin(w0 * phase), 0.0), along(-out.y(), out.x(), 0.0);
    Reference reference;
    reference.position = radius * out + Eigen::Vector3d(0.0, 0.0, climb * phase);
    reference.velocity = radius * w * along + Eigen::Vector3d(0.0, 0.0, climb * rate);
    reference.acceleration = radius * (a * along - w * w * out) + Eigen::Vector3d(0.0, 0.0, climb * a / w0);
    reference.jerk =
        radius * ((j - w * w * w) * along - 3.0 * w * a * out) + Eigen::Vector3d(0.0, 0.0, climb * j / w0);
    return reference;
  };
}

}  // namespace polyfly
