#include "polyfly_test/dryden_turbulence.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace polyfly {
namespace {

constexpr double kUpright = 1e-6;  // a wind straight up has no direction across

Eigen::Matrix3d windAxes(const Eigen::Vector3d& mean) {
  const Eigen::Vector3d along = mean.normalized();
  Eigen::Vector3d across = Eigen::Vector3d::UnitZ().cross(along);
  if (across.norm() < kUpright) across = Eigen::Vector3d::UnitY();
  across.normalize();
  Eigen::Matrix3d axes;
  axes << along, across, along.cross(across);
  return axes;
}

}  // namespace

// States of each axis: z1' = (-z1 + noise) / T, z2' = (-z2 + z1) / T. Scaled to var z1 = 1 they have the
// stationary covariance P = [1 1/2; 1/2 1/2]; over a step h they change by Phi = e^(-h/T) [1 0; h/T 1] and
// noise of the covariance P - Phi P Phi', whose Cholesky factor is drawn from.
DrydenTurbulence::DrydenTurbulence(const Eigen::Vector3d& mean, const Eigen::Vector3d& sigma, double length,
                                   double step, std::uint64_t seed)
    : noise_(seed), axes_(windAxes(mean)), sigma_(sigma) {
  const double share = step * mean.norm() / length;  // h / T
  decay_ = std::exp(-share);
  mixing_ = share * decay_;
  const double squared = decay_ * decay_;
  const double q11 = -std::expm1(-2.0 * share);
  const double q12 = 0.5 * q11 - share * squared;
  const double q22 = 0.5 * q11 - share * squared - share * share * squared;
  drive_ = std::sqrt(q11);
  second_drive_[0] = q12 / drive_;
  second_drive_[1] = std::sqrt(std::max(0.0, q22 - second_drive_[0] * second_drive_[0]));
  const Eigen::Vector3d first = noise_.next3();
  const Eigen::Vector3d second = noise_.next3();
  z_.col(0) = first;
  z_.col(1) = 0.5 * (first + second);
  compose();
}

void DrydenTurbulence::advance() {
  const Eigen::Vector3d first = noise_.next3();
  const Eigen::Vector3d second = noise_.next3();
  z_.col(1) =
      (mixing_ * z_.col(0) + decay_ * z_.col(1) + second_drive_[0] * first + second_drive_[1] * second)
          .eval();
  z_.col(0) = (decay_ * z_.col(0) + drive_ * first).eval();
  compose();
}

// (1 + sqrt(3) T s) / (1 + T s)^2 = sqrt(3) / (1 + T s) + (1 - sqrt(3)) / (1 + T s)^2, of variance 2.
void DrydenTurbulence::compose() {
  const double root = std::sqrt(3.0);
  Eigen::Vector3d local = (root * z_.col(0) + (1.0 - root) * z_.col(1)) / std::sqrt(2.0);
  local[0] = z_(0, 0);
  velocity_ = axes_ * sigma_.cwiseProduct(local);
}

}  // namespace polyfly
