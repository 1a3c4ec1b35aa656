#pragma once

#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// Notices odometry that repeats itself under new stamps while the vehicle must be moving, as an estimator
/// does that stands still. One part of the sample, pose or twist, has then been the same for longer than
/// repeat_time, although
/// - the other part has said for as long that the vehicle moves (0.2 m/s or 0.2 rad/s on the mean); or
/// - commands have asked for as long for another motion than the first of these samples was answered with:
///   0.05 rad of tilt or 0.1 rad/s with thrust that carries the vehicle, or thrust that lifts it.
///
/// A repetition alone does not count. A simulator at rest or in equilibrium says the same again and again. So does a
/// publisher of slow odometry at a higher rate, for less than repeat_time. A twist of zero is the same as none.
class RepeatCheck {
 public:
  /// Takes the next sample, a valid one. Whether odometry has repeated itself for longer than `repeat_time`
  /// [s] while the vehicle must be moving; 0: never.
  bool repeats(const VehicleState& state, double repeat_time) noexcept;

  /// The command with which the last sample was answered, while the vehicle is in the air: on the ground it
  /// need not move.
  void commanded(const AttitudeCommand& command, const MultirotorOptions& vehicle) noexcept;

 private:
  /// Since when a part of the samples is the same, and what was said and asked meanwhile.
  struct Stretch {
    void add(const VehicleState& before, const VehicleState& state) noexcept;

    VehicleState first;
    // Integral of the velocities, in W [m].
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();
    // Integral of the body rates [rad].
    Eigen::Vector3d turned = Eigen::Vector3d::Zero();
    // Command in answer to the first sample.
    AttitudeCommand command;
    bool has_command = false;
    // True when a later command has asked for another motion than `command`.
    bool asked = false;
    double asked_at = 0.0;  // [s]
  };

  VehicleState last_;
  Stretch pose_, twist_;
  bool started_ = false;
};

}  // namespace polyfly
