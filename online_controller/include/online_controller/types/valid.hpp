#pragma once

#include "online_controller/types/types.hpp"

namespace polyfly {

/// Finite, of a magnitude below 1e6, and with a quaternion of unit length within 5 %. Large finite numbers
/// would poison an observer as surely as NaN does.
bool isValid(const VehicleState& state) noexcept;
bool isValid(const Reference& reference) noexcept;

}  // namespace polyfly
