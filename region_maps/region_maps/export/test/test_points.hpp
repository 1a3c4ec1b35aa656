#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "synthetic_map.hpp"

namespace polyfly {

/// Seeded parameters of a map, of all kinds in turn: within, on planes, one step beside planes, at vertices of the
/// box, just outside and far outside of it, denormal, NaN and infinite.
class TestPoints {
 public:
  TestPoints(const RegionMap& map, std::uint64_t seed) : map_(map), random_(seed) {}

  std::vector<double> next() {
    switch (count_++ % 10) {
      case 0:
      case 1:
      case 2:
        return within(1.0);
      case 3:
        return within(1.2);
      case 4:
        return onPlane(within(1.0));
      case 5:
        return besidePlane();
      case 6:
        return vertex();
      case 7:
        return onPlane(onPlane(within(1.0)));
      case 8:
        return special();
      default:
        return within(1e6);
    }
  }

 private:
  std::vector<double> within(double part) {
    std::vector<double> theta;
    for (const Signal& signal : map_.parameters()) {
      const double half = 0.5 * (signal.upper - signal.lower);
      std::uniform_real_distribution<double> uniform(-part * half, part * half);
      theta.push_back(signal.lower + half + uniform(random_));
    }
    return theta;
  }

  std::vector<double> onPlane(std::vector<double> theta) {
    const std::size_t p = theta.size();
    if (map_.planeCount() == 0) return theta;
    const double* const plane = map_.plane(random_() % map_.planeCount());
    const std::size_t k = random_() % p;
    double rest = plane[p];
    for (std::size_t i = 0; i < p; ++i) rest -= plane[i] * theta[i];
    if (plane[k] != 0.0) theta[k] += rest / plane[k];
    return theta;
  }

  std::vector<double> besidePlane() {
    std::vector<double> theta = onPlane(within(1.0));
    double& value = theta[random_() % theta.size()];
    value = std::nextafter(value, random_() % 2 == 0 ? -1e9 : 1e9);
    return theta;
  }

  std::vector<double> vertex() {
    std::vector<double> theta;
    for (const Signal& signal : map_.parameters()) {
      const double bound = random_() % 2 == 0 ? signal.lower : signal.upper;
      theta.push_back(random_() % 4 == 0 ? std::nextafter(bound, 1e9 * (random_() % 2 == 0 ? 1.0 : -1.0))
                                         : bound);
    }
    return theta;
  }

  std::vector<double> special() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr double kSpecial[] = {std::numeric_limits<double>::quiet_NaN(),
                                   kInfinity,
                                   -kInfinity,
                                   std::numeric_limits<double>::denorm_min(),
                                   -std::numeric_limits<double>::denorm_min(),
                                   0.0,
                                   -0.0,
                                   std::numeric_limits<double>::max(),
                                   1e-310};
    std::vector<double> theta = within(random_() % 2 == 0 ? 1.0 : 1.5);
    for (std::size_t i = 0; i < 2; ++i)
      theta[random_() % theta.size()] = kSpecial[random_() % std::size(kSpecial)];
    return theta;
  }

  const RegionMap& map_;
  std::mt19937_64 random_;
  std::uint64_t count_ = 0;
};

}  // namespace polyfly
