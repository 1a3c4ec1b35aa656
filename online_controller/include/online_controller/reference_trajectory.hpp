#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "online_controller/types.hpp"

namespace polyfly {

/// One point of a trajectory, in the world frame.
struct TrajectorySample {
  double time = 0.0;                                       ///< [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< [m/s^2]
  double yaw = 0.0;                                        ///< [rad], any turn
  double yaw_rate = 0.0;                                   ///< [rad/s]
  bool has_velocity =
      false;  ///< velocity and yaw_rate were given; else they come from differences of neighbours
  bool has_acceleration =
      false;  ///< acceleration was given; else it comes from differences of the velocities
};

/// What to track over time. Built outside the control step and then only read.
///
/// - Between two samples the position follows the quintic through both positions, velocities and
/// accelerations, so
///   acceleration is continuous; velocity, acceleration and jerk are its derivatives. Yaw takes the shorter
///   way from sample to sample, along the cubic through both yaw rates.
/// - What a sample does not give is taken from the parabola through it and its neighbours (at an end: from
/// the line to
///   the one neighbour).
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

 private:
  std::vector<TrajectorySample> samples_;
};

/// The trajectory in force, and the one that takes over at its start. Times of its trajectories count from
/// their start.
class ReferenceSchedule {
 public:
  /// Takes over at time `start` [s], or with the next sample when there is none. It replaces a trajectory
  /// that still waits; the one in force ends when it takes over. The first of all is in force at once and
  /// holds its first pose until its start. An empty trajectory is ignored.
  void set(ReferenceTrajectory trajectory, std::optional<double> start);

  /// The reference at `time` [s], nothing before the first trajectory. Does not allocate.
  std::optional<Reference> sample(double time) noexcept;

  /// The references at `time` and at each `period` [s] after it, `count` of them; a trajectory that waits is
  /// seen in advance. False, and nothing is written, before the first trajectory. Does not allocate.
  bool preview(double time, double period, int count, Reference* references) noexcept;

 private:
  struct Entry {
    ReferenceTrajectory trajectory;
    std::optional<double> start;
  };
  Entry active_;
  Entry next_;
  bool next_waits_ = false;
};

}  // namespace polyfly
