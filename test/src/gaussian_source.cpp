#include "polyfly_test/gaussian_source.hpp"

#include <cmath>

namespace polyfly {
namespace {

constexpr double kTwoPi = 6.283185307179586;

// The upper 53 bits, moved by half a step: strictly between 0 and 1, so that its logarithm is finite.
double uniform(std::mt19937_64& engine) { return (static_cast<double>(engine() >> 11) + 0.5) * 0x1p-53; }

}  // namespace

double GaussianSource::next() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  // Box and Muller: two uniform numbers give two normal ones.
  const double radius = std::sqrt(-2.0 * std::log(uniform(engine_)));
  const double angle = kTwoPi * uniform(engine_);
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

Eigen::Vector3d GaussianSource::next3() {
  const double x = next();
  const double y = next();
  const double z = next();
  return {x, y, z};
}

}  // namespace polyfly
