#pragma once

#include <Eigen/Core>

#include "online_controller/types/types.hpp"

namespace polyfly {

/// Notices velocities that do not lead from position to position: of another frame, sign or unit. The gate
/// cannot, because from sample to sample the difference is small. A vehicle at rest tells nothing.
class VelocityCheck {
 public:
  /// Takes a sample in its order of time. Compares the integrated velocity with the way between the positions over
  /// windows of a second. True while each of the last two windows differs by more than 0.2 m and 30 % of the way. A
  /// gap of half a second or a stamp that goes back begins anew.
  bool contradicts(const VehicleState& state) noexcept;

  void restart() noexcept { *this = VelocityCheck(); }

 private:
  void beginWindow(const VehicleState& state) noexcept;

  bool started_ = false;
  VehicleState last_;
  /// Start of the window [s].
  double begin_ = 0.0;
  /// Position at the start of the window [m].
  Eigen::Vector3d from_ = Eigen::Vector3d::Zero();
  /// Integral of the velocity in the window [m].
  Eigen::Vector3d moved_ = Eigen::Vector3d::Zero();
  /// Integral of the magnitude of the velocity in the window [m].
  double way_ = 0.0;
  /// Number of windows in a row in which velocity and positions did not agree.
  int missed_ = 0;
};

}  // namespace polyfly
