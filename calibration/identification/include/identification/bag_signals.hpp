#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "bags/scan_bag.hpp"
#include "identification/flight_signals.hpp"

namespace polyfly {

/// Which topics of a bag to listen to.
struct BagSignalOptions {
  std::vector<std::string> topics;  ///< only these, and only names that end in one of them; all if empty
  std::string name_space;           ///< only topics in it, if not empty; with or without slashes around it
  /// Signal to `topic:path.of.a.number`, or `topic:path.of.a.quaternion.roll` (or pitch, yaw).
  /// `:deg` after a number makes radians of degrees.
  std::map<std::string, std::string> choice;
  std::function<void(double)> progress;  ///< share of the file that was read
};

struct BagSignals {
  FlightSignals signals;  ///< times count from the bag's first message
  BagHealth health;       ///< with a remark for each topic whose messages or clock are wrong
};

/// Finds the signals by the types of the messages. The first kind that the bag holds is taken.
///
/// Commands:
/// - mav_msgs/RollPitchYawrateThrust;
/// - mavros_msgs/AttitudeTarget;
/// - geometry_msgs/PoseStamped on a topic called attitude, with std_msgs/Float64 on one called throttle or thrust.
///
/// Measurements:
/// - nav_msgs/Odometry, with the twist in the body's frame;
/// - sensor_msgs/Imu;
/// - attitude in geometry_msgs/TransformStamped, or in a PoseStamped on a topic called pose that is no command or
///   setpoint, with velocities in geometry_msgs/TwistStamped on a topic called velocity_local.
/// Topics of a ground_truth come last.
///
/// Times are those of the headers; where there are none, or where a header's clock jumps against the recorder's, those
/// of the recorder. Throws Error naming file, topic and rule: two topics for one signal, a chosen topic or field that
/// is not there, no bag.
BagSignals signalsFromBag(const std::string& path, const BagSignalOptions& options);

}  // namespace polyfly
