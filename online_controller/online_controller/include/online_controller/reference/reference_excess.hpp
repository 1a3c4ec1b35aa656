#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "online_controller/reference/reference_trajectory.hpp"
#include "online_controller/types/reference_limits.hpp"

namespace polyfly {

/// The first point of a reference that asks for too much.
struct ReferenceExcess {
  /// Option that is exceeded; nullptr: none.
  const char* limit = nullptr;
  double value = 0.0;  ///< [m, m/s]
  double most = 0.0;   ///< [m, m/s]
  std::size_t sample = 0;
  /// True when the point is the only one of the reference.
  bool pose = false;
};

/// `vehicle`: where it is, or nullptr where that is not known: then only the speed counts. Does not allocate.
ReferenceExcess findExcess(const ReferenceTrajectory& trajectory, const Eigen::Vector3d* vehicle,
                           const ReferenceLimits& limits) noexcept;

/// "pose: lies 2000 m from the vehicle, more than reference_limits/distance, 1000 m".
std::string describe(const ReferenceExcess& excess);

}  // namespace polyfly
