#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "online_controller/types/types.hpp"

namespace polyfly {

/// One point of a trajectory, in the world frame.
struct TrajectorySample {
  double time = 0.0;                                       ///< [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< [m/s^2]
  double yaw = 0.0;                                        ///< [rad], any turn
  double yaw_rate = 0.0;                                   ///< [rad/s]
  bool has_velocity = false;      ///< velocity and yaw_rate were given; else they are computed
  bool has_acceleration = false;  ///< acceleration was given; else it is computed
};

/// What to track over time. Built outside the control step and then only read.
///
/// - Between two samples the position follows the quintic through both positions, velocities and
/// accelerations, so
///   acceleration is continuous; velocity, acceleration and jerk are its derivatives. Yaw takes the shorter
///   way from sample to sample, along the cubic through both yaw rates.
/// - Velocities that are not given, and the accelerations there and beside them, are those of the cubic
/// spline through
///   the positions and whatever velocities are given: with continuous acceleration and the jerk that the path
///   has, which differences of neighbours exceed by far. Other accelerations that are missing are taken from
///   the parabola through the velocities of the sample and its neighbours (at an end: the line to the one
///   neighbour).
/// - Before the first sample its position and yaw are held, after the last one that one's, both at rest.
/// - A single sample is a pose to hold; its velocity and acceleration have no meaning.
class ReferenceTrajectory {
 public:
  static constexpr std::size_t kMaxSamples = 100000;
  static constexpr double kLeastInterval = 1e-4;  ///< between two samples [s]
  static constexpr double kLargestNumber = 1e6;   ///< magnitude of any entry but the times [SI]

  /// Nothing to track: empty() holds and sample() returns zeros.
  ReferenceTrajectory() = default;

  /// Throws Error naming the sample and the rule: 1 to kMaxSamples samples, all finite and not above
  /// kLargestNumber, times increasing by kLeastInterval or more.
  explicit ReferenceTrajectory(std::vector<TrajectorySample> samples);

  /// Points whose velocity, and whose acceleration, was computed because it was not given. None of a pose.
  std::size_t computedVelocities() const noexcept { return computed_velocities_; }
  std::size_t computedAccelerations() const noexcept { return computed_accelerations_; }

  /// Holds a pose for ever.
  static ReferenceTrajectory pose(const Eigen::Vector3d& position, double yaw);

  bool empty() const noexcept { return samples_.empty(); }
  double startTime() const noexcept { return empty() ? 0.0 : samples_.front().time; }
  double endTime() const noexcept { return empty() ? 0.0 : samples_.back().time; }
  const std::vector<TrajectorySample>& samples() const noexcept {
    return samples_;
  }  ///< completed, yaw unwrapped

  /// The reference at `time` [s]. Does not allocate.
  Reference sample(double time) const noexcept;

  /// Becomes such a pose. Allocates only where no trajectory was before.
  void becomePose(const Eigen::Vector3d& position, double yaw);

  /// The trajectory `first` until the start of `second`, which begins `offset` [s] after it, later than its end. The
  /// way from the last point of the one to the first of the other is part of it.
  static ReferenceTrajectory joined(const ReferenceTrajectory& first, const ReferenceTrajectory& second,
                                    double offset);

 private:
  std::vector<TrajectorySample> samples_;
  std::size_t computed_velocities_ = 0;
  std::size_t computed_accelerations_ = 0;
};

}  // namespace polyfly
