#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "online_controller/types/attitude.hpp"
#include "region_maps/lookup.hpp"

namespace polyfly {

/// Vehicle state from odometry. World frame W: x forward at yaw 0, y left, z up (ENU).
struct VehicleState {
  double stamp = 0.0;                                            ///< [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();            ///< [m], frame W
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();            ///< [m/s], frame W
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();  ///< body to W
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();    ///< [rad/s], body frame
};

/// The state of a vehicle whose heading is that of the odometry's attitude plus `misalignment` [rad], about the z axis of
/// W. Position, velocity and rates stay: they are known in W or in the body.
inline VehicleState aligned(VehicleState state, double misalignment) noexcept {
  if (misalignment != 0.0)
    state.attitude = Eigen::AngleAxisd(misalignment, Eigen::Vector3d::UnitZ()) * state.attitude;
  return state;
}

/// What to track at one instant, in W.
struct Reference {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      ///< [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< [m/s^2]
  Eigen::Vector3d jerk = Eigen::Vector3d::Zero();          ///< [m/s^3]
  double yaw = 0.0;                                        ///< [rad]
  double yaw_rate = 0.0;                                   ///< [rad/s]
};

/// Command to the attitude controller.
struct AttitudeCommand {
  double roll = 0.0;      ///< [rad]
  double pitch = 0.0;     ///< [rad]
  double yaw_rate = 0.0;  ///< [rad/s]
  double thrust = 0.0;    ///< along body z [N]
};

/// Why the command is what it is. Up to kLevel worse states have greater numbers; kLeastViolation stands between
/// kClipped and kHoldLast. The step reports the worst of the axes.
enum class ControlStatus : std::uint8_t {
  /// Answer of the law. With a reason: outside its map, by solving the map's problem online.
  kOptimal = 0,
  /// A parameter left the map's box. It was clipped to the box and the law evaluated there.
  kClipped = 1,
  /// No answer for this sample: the last command is repeated.
  kHoldLast = 2,
  /// No answer for longer: level attitude, hover thrust.
  kLevel = 3,
  /// Nothing to track yet: nothing is sent, or what an autopilot needs that is not guided yet.
  kNoReference = 4,
  /// No answer for longer than at kLevel: level attitude, less than hover thrust.
  kDescend = 5,
  /// Nothing is sent any more.
  kStopped = 6,
  /// Command of the pilot's sticks, without a law.
  kManual = 7,
  /// On the ground: no thrust.
  kMotorsOff = 8,
  /// Answer of the law within all limits, but the search was ended before the optimum, or the reason is kContradiction.
  kSuboptimal = 9,
  /// Robust law: no plan meets all bounds. Its answer at the greatest share of the errors that has one.
  kLeastViolation = 10,
};
constexpr int kControlStatusCount = 11;

/// Whether what is sent is a law's answer to the sample.
constexpr bool isAnswer(ControlStatus status) noexcept {
  return status == ControlStatus::kOptimal || status == ControlStatus::kClipped ||
         status == ControlStatus::kSuboptimal || status == ControlStatus::kLeastViolation;
}

/// Why an axis had no answer or a changed one.
enum class ControlReason : std::uint8_t {
  kNone = 0,
  /// A parameter is out of range.
  kOutsideBox = 1,
  /// There is no region at the parameter or no solution: infeasible.
  kOutsidePartition = 2,
  /// There is NaN or infinity in the odometry or reference.
  kNotFinite = 3,
  /// Odometry is silent, or repeats itself while the vehicle must be moving.
  kStale = 4,
  kNoReference = 5,
  /// Position or attitude is further from the last one than velocities and rates explain.
  kJump = 6,
  /// The stamp is before that of the last sample.
  kOutOfOrder = 7,
  /// Odometry is in another frame than agreed.
  kWrongFrame = 8,
  /// The vehicle has landed, or has not taken off yet.
  kOnGround = 9,
  /// The remote control has the vehicle.
  kPilot = 10,
  /// Odometry contradicts itself: the velocity of its positions is flown, or the attitude to which its rates lead.
  kContradiction = 11,
};
constexpr int kControlReasonCount = 12;

constexpr int kMaxParameters = 10;

/// What one axis did in one step.
struct AxisReport {
  /// Parameters as assembled, before clipping, in the map's order.
  std::array<double, kMaxParameters> theta{};
  /// Number of parameters, 0 if none could be assembled.
  int size = 0;
  /// Status of the look-up of `theta` before clipping.
  LookupStatus lookup = LookupStatus::kNotFinite;
  /// First parameter out of range, or -1.
  int outside_parameter = -1;
  /// Region used, or -1.
  std::int64_t region = -1;
  /// Input u of the axis: angle [rad] or acceleration [m/s^2].
  double input = 0.0;
  /// Estimate of the observer [m/s^2].
  double disturbance = 0.0;
  /// Number of working sets of the linear law's QP.
  int iterations = 0;
};

/// Everything that one control step produced.
struct ControlReport {
  /// Stamp of the odometry, or the time at which its silence was noticed [s].
  double stamp = 0.0;
  ControlStatus status = ControlStatus::kNoReference;
  ControlReason reason = ControlReason::kNoReference;
  AttitudeCommand command;
  /// Axes longitudinal (x), lateral (y), vertical (z).
  std::array<AxisReport, 3> axis;
  /// Number of working sets of the QPs of the laws that solve online.
  int iterations = 0;
  /// Step of the nonlinear law: greatest change of an input [rad, m/s^2].
  double step_length = 0.0;
  /// Commands at which the vehicle is level, see AttitudeTrim [rad].
  TiltAngles trim;
  /// Commands to be level with when nothing corrects them, see AttitudeTrim::level [rad].
  TiltAngles level_trim;
  /// Coupling of yaw rate and tilt in the attitude loops, see AttitudeTrim [1].
  double coupling = 0.0;
  /// The attitude loops: the law's model, and what controller/adapt_model found.
  TiltModel loops;
  /// Drag beyond the model's along x and y, found by controller/adapt_model [1/s].
  std::array<double, 2> found_drag{};
  /// Whether the commands of tilt swing by more than the reference needs, see SwingWatch.
  bool swings = false;
  /// Robust law: constant force in W that it does not remove, 0 along an axis where that is at most a third of the
  /// disturbance's range [N].
  Eigen::Vector3d force_left = Eigen::Vector3d::Zero();
};

/// Whether an explicit law's map did not hold a parameter, and the answer comes from another place. It was solved
/// online (kOptimal), or looked up at other parameters (kClipped, kLeastViolation).
constexpr bool isOutsideMap(const ControlReport& report) noexcept {
  return isAnswer(report.status) &&
         (report.reason == ControlReason::kOutsideBox || report.reason == ControlReason::kOutsidePartition);
}

}  // namespace polyfly
