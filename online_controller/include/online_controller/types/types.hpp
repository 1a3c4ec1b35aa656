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
  Eigen::Vector3d position = Eigen::Vector3d::Zero();            ///< in W [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();            ///< in W [m/s]
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();  ///< body to W
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();    ///< in body [rad/s]
};

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

/// Why the command is what it is. Up to kLevel worse states have greater numbers; the step reports the worst
/// of the axes.
enum class ControlStatus : std::uint8_t {
  kOptimal = 0,   ///< the law's answer; with a reason: outside its map, by solving the map's problem online
  kClipped = 1,   ///< a parameter left the map's box; it was clipped to the box and the law evaluated there
  kHoldLast = 2,  ///< no answer for this sample: the last command is repeated
  kLevel = 3,     ///< no answer for longer: level attitude, hover thrust
  kNoReference = 4,  ///< nothing to track yet: level attitude, hover thrust
  kDescend = 5,      ///< no answer for longer than that: level attitude, less than hover thrust
  kStopped = 6,      ///< nothing is sent any more, or yet
  kManual = 7,       ///< the pilot's sticks, without a law
  kMotorsOff = 8,    ///< on the ground: no thrust
  kSuboptimal = 9,   ///< the law's answer, within all limits, but its search was ended before the optimum
};
constexpr int kControlStatusCount = 10;

/// Whether what is sent is a law's answer to the sample.
constexpr bool isAnswer(ControlStatus status) noexcept {
  return status == ControlStatus::kOptimal || status == ControlStatus::kClipped ||
         status == ControlStatus::kSuboptimal;
}

/// Why an axis had no answer or a changed one.
enum class ControlReason : std::uint8_t {
  kNone = 0,
  kOutsideBox = 1,        ///< parameter out of range
  kOutsidePartition = 2,  ///< no region at the parameter or no solution: infeasible
  kNotFinite = 3,         ///< NaN or infinity in the odometry or reference
  kStale = 4,             ///< odometry silent, or repeating itself while the vehicle must be moving
  kNoReference = 5,
  kJump = 6,        ///< position or attitude further from the last one than velocities and rates explain
  kOutOfOrder = 7,  ///< stamp before that of the last sample
  kWrongFrame = 8,  ///< odometry in another frame than agreed
  kOnGround = 9,    ///< landed, or not taken off yet
  kPilot = 10,      ///< the remote control has the vehicle
};

constexpr int kMaxParameters = 8;

/// What one axis did in one step.
struct AxisReport {
  /// Parameters as assembled, before clipping, in the map's order.
  std::array<double, kMaxParameters> theta{};
  int size = 0;                                    ///< number of parameters, 0 if none could be assembled
  LookupStatus lookup = LookupStatus::kNotFinite;  ///< of `theta` before clipping
  int outside_parameter = -1;                      ///< first parameter out of range, or -1
  std::int64_t region = -1;                        ///< region used, or -1
  double input = 0.0;                              ///< u of the axis (angle [rad] or acceleration [m/s^2])
  double disturbance = 0.0;                        ///< observer's estimate [m/s^2]
  int iterations = 0;                              ///< of the linear law: working sets of its QP
};

/// Everything that one control step produced.
struct ControlReport {
  double stamp = 0.0;  ///< of the odometry, or the time at which its silence was noticed [s]
  ControlStatus status = ControlStatus::kNoReference;
  ControlReason reason = ControlReason::kNoReference;
  AttitudeCommand command;
  std::array<AxisReport, 3> axis;  ///< longitudinal (x), lateral (y), vertical (z)
  int iterations = 0;              ///< working sets of the QPs of the laws that solve online
  double step_length = 0.0;        ///< of the nonlinear law: greatest change of an input [rad, m/s^2]
  TiltAngles trim;                 ///< commands at which the vehicle is level, see AttitudeTrim [rad]
  double coupling = 0.0;           ///< of yaw rate and tilt in the attitude loops, see AttitudeTrim [1]
};

}  // namespace polyfly
