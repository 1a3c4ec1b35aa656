#include "fixedwing_plant/dryden.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kFoot = 0.3048;  // [m]

}  // namespace

DrydenOptions lowAltitudeDryden(double altitude, double wind_at_6m, double span) {
  const double feet = std::clamp(altitude / kFoot, 10.0, 1000.0);
  const double shape = 0.177 + 0.000823 * feet;
  DrydenOptions options;
  const double down = 0.1 * wind_at_6m;
  const double level = down / std::pow(shape, 0.4);
  options.deviation = {level, level, down};
  const double long_scale = kFoot * feet / std::pow(shape, 1.2);
  options.scale = {long_scale, long_scale, kFoot * feet};
  options.span = span;
  // The integral of the specification's spectrum of p.
  const double ratio = kPi * options.scale.z() / (4.0 * span);
  options.roll_deviation = down * std::sqrt(0.1 * kPi * kPi / (span * options.scale.z()) * std::cbrt(ratio));
  return options;
}

// Both lags begin as the steady process has them: variances 1 and 1/2, covariance 1/2.
DrydenGusts::DrydenGusts(const DrydenOptions& options, std::uint32_t seed)
    : options_(options), random_(seed) {
  for (int axis = 0; axis < 3; ++axis) {
    first_[axis] = draw();
    second_[axis] = 0.5 * first_[axis] + 0.5 * draw();
  }
  roll_ = draw();
  compose();
}

void DrydenGusts::step(double airspeed, double duration) {
  for (int axis = 0; axis < 3; ++axis) {
    const double x = airspeed / options_.scale[axis] * duration;
    const double e = std::exp(-x);
    // z1' = -w z1 + sqrt(2 w) n, z2' = w (z1 - z2): the noise of a step is what keeps the steady covariance
    // [1 1/2; 1/2 1/2] under the step [e 0; x e e].
    const double q11 = 1.0 - e * e;
    const double q12 = 0.5 - e * e * (0.5 + x);
    const double q22 = 0.5 - e * e * (0.5 + x + x * x);
    const double l11 = std::sqrt(q11);
    const double l21 = q12 / l11;
    const double l22 = std::sqrt(std::max(0.0, q22 - l21 * l21));
    const double n1 = draw();
    second_[axis] = e * second_[axis] + x * e * first_[axis] + l21 * n1 + l22 * draw();
    first_[axis] = e * first_[axis] + l11 * n1;
  }
  const double e = std::exp(-kPi * airspeed / (4.0 * options_.span) * duration);
  roll_ = e * roll_ + std::sqrt(1.0 - e * e) * draw();
  compose();
}

// sqrt(w) (w + sqrt(3) s) / (s + w)^2 in partial fractions of the two lags.
void DrydenGusts::compose() {
  const double root = std::sqrt(3.0);
  const Eigen::Vector3d across = (root * first_ + (1.0 - root) * second_) / std::sqrt(2.0);
  velocity_ = options_.deviation.cwiseProduct(Eigen::Vector3d(first_.x(), across.y(), across.z()));
  roll_rate_ = options_.roll_deviation * roll_;
}

}  // namespace polyfly
