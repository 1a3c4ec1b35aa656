#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <mav_msgs/RollPitchYawrateThrust.h>
#include <mavros_msgs/AttitudeTarget.h>
#include <nav_msgs/Odometry.h>
#include <online_controller/AxisStatus.h>
#include <online_controller/ControllerStatus.h>
#include <trajectory_msgs/MultiDOFJointTrajectory.h>

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "online_controller/reference/reference_schedule.hpp"
#include "online_controller/types/thrust_curve.hpp"
#include "online_controller/types/types.hpp"
#include "region_maps/signal.hpp"

// The only place where messages become values and frames change. Also for replaying a bag.
namespace polyfly_ros {

/// Whether a message's constants are 0, 1, 2, ... in this order, as the enumerators that it restates.
constexpr bool areCounted(std::initializer_list<int> constants) {
  int next = 0;
  for (const int constant : constants) {
    if (constant != next++) return false;
  }
  return true;
}

/// The twist of an odometry message is in its child frame, the body: the velocity is rotated to the world.
/// The quaternion is normalised; one that is not finite or far from unit length becomes NaN, which the
/// controller refuses.
polyfly::VehicleState toVehicleState(const nav_msgs::Odometry& message);

/// Times count from the header's stamp, see startOf. Each point has one transform; yaw comes from its
/// rotation, tilt is ignored. Points without velocities or accelerations leave these to ReferenceTrajectory.
/// A velocity's angular z is the yaw rate. Throws Error naming topic, point and rule.
polyfly::ReferenceTrajectory toReferenceTrajectory(const trajectory_msgs::MultiDOFJointTrajectory& message);

/// When the trajectory starts: its stamp [s], or nothing (with the next odometry) where the stamp is zero.
std::optional<double> startOf(const trajectory_msgs::MultiDOFJointTrajectory& message);

/// A pose to hold; tilt is ignored, and so is the stamp: it counts from the next odometry. Throws Error.
polyfly::ReferenceTrajectory toReferenceTrajectory(const geometry_msgs::PoseStamped& message);

/// Roll, pitch, yaw rate and thrust; the caller sets the header.
void fillCommand(const polyfly::AttitudeCommand& command, mav_msgs::RollPitchYawrateThrust& message);

/// For mavros: attitude of the body (forward, left, up) in the world (east, north, up), as it expects on
/// setpoint_raw/attitude. `yaw` is the vehicle's own [rad], since autopilots take the rate of yaw from body_rate.z.
/// Thrust through the curve. The caller sets the header.
void fillAttitudeTarget(const polyfly::AttitudeCommand& command, double yaw,
                        const polyfly::ThrustCurve& curve, mavros_msgs::AttitudeTarget& message);

/// Yaw of the vehicle [rad], NaN where its attitude is not finite.
double yawOf(const polyfly::VehicleState& state);

/// Status, reason and axes; the caller sets header, sequence and times. `parameters` names those of each
/// axis.
void fillStatus(const polyfly::ControlReport& report,
                const std::array<std::vector<polyfly::Signal>, 3>& parameters,
                online_controller::ControllerStatus& message);

/// "level attitude, hover thrust".
const char* words(polyfly::ControlStatus status);

/// "clipped: e_p_x outside the range of its map", for logs, the status message and diagnostics; with remarkOn(report).
/// Without `parameters` it names none.
std::string describe(const polyfly::ControlReport& report,
                     const std::array<std::vector<polyfly::Signal>, 3>* parameters = nullptr);

/// Whether that is what somebody has asked for: a law's answer (an explicit one's within its maps), the sticks, or
/// standing on the ground. An answer with a remark is not.
bool isAsAsked(const polyfly::ControlReport& report) noexcept;

}  // namespace polyfly_ros
