#pragma once

#include <Eigen/Core>

#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// What laws are measured by: a = a_ref + 6 e + 4.5 de/dt + 1.2 int e, with e = reference - state. Thrust and tilt
/// give this acceleration at the yaw of now, within the limits of the options. It knows no model of the attitude loop,
/// and no drag.
class PiController {
 public:
  explicit PiController(const MultirotorOptions& options) : options_(options) {}

  /// One control period. The integral rests while a limit is active.
  AttitudeCommand step(const VehicleState& state, const Reference& reference);

 private:
  MultirotorOptions options_;
  Eigen::Vector3d integral_ = Eigen::Vector3d::Zero();  // [m s]
};

}  // namespace polyfly
