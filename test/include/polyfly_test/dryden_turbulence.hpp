#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "polyfly_test/gaussian_source.hpp"

namespace polyfly {

/// Dryden turbulence (MIL-F-8785C) in a frozen mean wind, as velocities in the axes of that wind: along it
/// the filter 1 / (1 + T s), across it and upwards (1 + sqrt(3) T s) / (1 + T s)^2, with T the length scale
/// divided by the wind speed. Each component has the standard deviation `sigma` at any step, from the first
/// number on.
class DrydenTurbulence {
 public:
  /// `mean` [m/s] must not vanish; `sigma` [m/s] per axis (along, across, up); `length` [m]; `step` [s].
  DrydenTurbulence(const Eigen::Vector3d& mean, const Eigen::Vector3d& sigma, double length, double step,
                   std::uint64_t seed);

  const Eigen::Vector3d& velocity() const { return velocity_; }  ///< turbulence alone, in W [m/s]
  void advance();                                                ///< one step

 private:
  void compose();

  GaussianSource noise_;
  Eigen::Matrix3d axes_;           // columns: along the wind, across, up
  Eigen::Vector3d sigma_;          // [m/s]
  double decay_ = 0.0;             // exp(-step / T)
  double drive_ = 0.0;             // of the first state
  double mixing_ = 0.0;            // first state into the second over a step
  Eigen::Vector2d second_drive_;   // of the second state: along the first one's noise, and by itself
  Eigen::Matrix<double, 3, 2> z_;  // states of each axis, variances 1 and 1/2
  Eigen::Vector3d velocity_;
};

}  // namespace polyfly
