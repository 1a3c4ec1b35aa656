#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "polyfly_test/gaussian_source.hpp"

namespace polyfly {

/// Dryden turbulence (MIL-F-8785C) in a frozen mean wind, as velocities in the axes of that wind. Along it the filter
/// is 1 / (1 + T s), across it and upwards (1 + sqrt(3) T s) / (1 + T s)^2. T is the length scale divided by the wind
/// speed. Each component has the standard deviation `sigma` at any step, from the first number on.
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
  // Columns: along the wind, across, up.
  Eigen::Matrix3d axes_;
  Eigen::Vector3d sigma_;  // [m/s]
  // Decay of a state over a step, exp(-step / T).
  double decay_ = 0.0;
  // Gain from the noise to the first state.
  double drive_ = 0.0;
  // Gain from the first state to the second over a step.
  double mixing_ = 0.0;
  // Gains to the second state: from the noise of the first state, and from its own noise.
  Eigen::Vector2d second_drive_;
  // States of each axis, with the variances 1 and 1/2.
  Eigen::Matrix<double, 3, 2> z_;
  Eigen::Vector3d velocity_;
};

}  // namespace polyfly
