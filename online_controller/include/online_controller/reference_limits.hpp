#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>

#include "mpc_core/range.hpp"
#include "online_controller/reference_trajectory.hpp"

namespace polyfly {

/// Within what a reference is believed. What asks for more is a slip of a digit, of a unit or of a frame.
struct ReferenceLimits {
  double distance = 1000.0;  ///< of any point from the vehicle when the reference comes [m]
  double height = 500.0;     ///< of any point above or below it [m]
  double speed = 30.0;       ///< of a trajectory, at its points and midway between them [m/s]
};

/// The one list of these options, as visitOptions of MultirotorOptions.
template <class Options, class Visit>
void visitReferenceLimits(Options& options, Visit&& visit) {
  visit("reference_limits/distance", options.distance, "m", Range{0.1, 1e7});
  visit("reference_limits/height", options.height, "m", Range{0.1, 1e7});
  visit("reference_limits/speed", options.speed, "m/s", Range{0.1, 1e7});
}

/// The first point of a reference that asks for too much.
struct ReferenceExcess {
  const char* limit = nullptr;  ///< the option that is exceeded; nullptr: none is
  double value = 0.0;           ///< [m, m/s]
  double most = 0.0;            ///< [m, m/s]
  std::size_t sample = 0;
  bool pose = false;  ///< it is the only point
};

/// `vehicle`: where it is, or nullptr where that is not known: then only the speed counts. Does not allocate.
ReferenceExcess findExcess(const ReferenceTrajectory& trajectory, const Eigen::Vector3d* vehicle,
                           const ReferenceLimits& limits) noexcept;

/// "pose: lies 2000 m from the vehicle, more than reference_limits/distance, 1000 m".
std::string describe(const ReferenceExcess& excess);

}  // namespace polyfly
