#pragma once

#include "online_controller/types/types.hpp"

namespace polyfly {

/// Finite and of a magnitude of at most 1e6. Large finite numbers would make an observer's estimate as useless as NaN
/// does.
bool isValidNumber(double value) noexcept;

/// All numbers are valid, and a quaternion has unit length within 5 %.
bool isValid(const VehicleState& state) noexcept;
bool isValid(const Reference& reference) noexcept;

}  // namespace polyfly
