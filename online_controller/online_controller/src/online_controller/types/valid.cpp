#include "online_controller/types/valid.hpp"

#include <cmath>

namespace polyfly {
namespace {

constexpr double kGreatestValidNumber = 1e6;  // [SI]
constexpr double kUnitTolerance = 0.05;

bool valid(const Eigen::Vector3d& vector) noexcept {
  return isValidNumber(vector.x()) && isValidNumber(vector.y()) && isValidNumber(vector.z());
}

}  // namespace

// False for NaN.
bool isValidNumber(double value) noexcept { return std::abs(value) <= kGreatestValidNumber; }

bool isValid(const VehicleState& state) noexcept {
  const double squared_norm = state.attitude.squaredNorm();
  return std::isfinite(state.stamp) && valid(state.position) && valid(state.velocity) &&
         std::abs(squared_norm - 1.0) <= 2.0 * kUnitTolerance;
}

bool isValid(const Reference& reference) noexcept {
  return valid(reference.position) && valid(reference.velocity) && valid(reference.acceleration) &&
         valid(reference.jerk) && isValidNumber(reference.yaw) && isValidNumber(reference.yaw_rate);
}

}  // namespace polyfly
