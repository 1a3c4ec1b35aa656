#include "online_controller/types/sane.hpp"

#include <cmath>

namespace polyfly {
namespace {

constexpr double kLargestSaneNumber = 1e6;  // [SI]
constexpr double kUnitTolerance = 0.05;

bool sane(double value) noexcept { return std::abs(value) <= kLargestSaneNumber; }  // false for NaN

bool sane(const Eigen::Vector3d& vector) noexcept {
  return sane(vector.x()) && sane(vector.y()) && sane(vector.z());
}

}  // namespace

bool isSane(const VehicleState& state) noexcept {
  const double squared_norm = state.attitude.squaredNorm();
  return std::isfinite(state.stamp) && sane(state.position) && sane(state.velocity) &&
         std::abs(squared_norm - 1.0) <= 2.0 * kUnitTolerance;
}

bool isSane(const Reference& reference) noexcept {
  return sane(reference.position) && sane(reference.velocity) && sane(reference.acceleration) &&
         sane(reference.jerk) && sane(reference.yaw) && sane(reference.yaw_rate);
}

}  // namespace polyfly
