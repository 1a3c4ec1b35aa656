#include "online_controller/types/valid.hpp"

#include <cmath>

namespace polyfly {
namespace {

constexpr double kGreatestValidNumber = 1e6;  // [SI]
constexpr double kUnitTolerance = 0.05;

bool valid(double value) noexcept { return std::abs(value) <= kGreatestValidNumber; }  // false for NaN

bool valid(const Eigen::Vector3d& vector) noexcept {
  return valid(vector.x()) && valid(vector.y()) && valid(vector.z());
}

}  // namespace

bool isValid(const VehicleState& state) noexcept {
  const double squared_norm = state.attitude.squaredNorm();
  return std::isfinite(state.stamp) && valid(state.position) && valid(state.velocity) &&
         std::abs(squared_norm - 1.0) <= 2.0 * kUnitTolerance;
}

bool isValid(const Reference& reference) noexcept {
  return valid(reference.position) && valid(reference.velocity) && valid(reference.acceleration) &&
         valid(reference.jerk) && valid(reference.yaw) && valid(reference.yaw_rate);
}

}  // namespace polyfly
