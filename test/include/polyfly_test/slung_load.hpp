#pragma once

#include <Eigen/Core>

namespace polyfly {

/// A point mass on an elastic string below a vehicle. The string pulls when it is longer than at rest, and
/// is slack otherwise. Vectors in W.
struct SlungLoad {
  /// Mass of the load [kg]. 0: there is none.
  double mass = 0.0;
  /// Length of the string at rest [m].
  double length = 0.65;
  double stiffness = 60.0;  ///< [N/m]
  /// Damping along the string while it is taut [N s/m].
  double damping = 0.4;
  /// Drag force per velocity through the air [N s/m].
  double drag = 0.0;

  /// Force of the string on the vehicle [N], where `offset` and `velocity` are the load's relative to the
  /// vehicle's. The load feels the opposite.
  Eigen::Vector3d pull(const Eigen::Vector3d& offset, const Eigen::Vector3d& velocity) const;

  /// How far below the vehicle it hangs at rest [m].
  double hangingLength(double gravity) const { return length + mass * gravity / stiffness; }
};

}  // namespace polyfly
