#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bags/scan_bag.hpp"
#include "identification/flight_signals.hpp"

namespace polyfly {

/// Which topics of a bag to listen to.
struct BagSignalOptions {
  std::vector<std::string> topics;  ///< only these, and only names that end in one of them; all if empty
  /// Signal to `topic:path.of.a.number`, or `topic:path.of.a.quaternion.roll` (or pitch, yaw).
  std::map<std::string, std::string> choice;
  std::function<void(double)> progress;  ///< share of the file that was read
  /// Asked where two topics could give a signal: the index of the one, or none. Error if there is nobody.
  std::function<std::optional<std::size_t>(const std::string& question,
                                           const std::vector<std::string>& choices)>
      ask;
};

struct BagSignals {
  FlightSignals signals;  ///< times count from the bag's first message
  BagHealth health;       ///< with a remark for each topic whose messages or clock are wrong
};

/// Finds the signals by the messages' types: commands in mav_msgs/RollPitchYawrateThrust, else in
/// mavros_msgs/AttitudeTarget, or in geometry_msgs/PoseStamped on a topic called attitude with
/// std_msgs/Float64 on one called throttle or thrust; measurements in nav_msgs/Odometry (twist in the body's
/// frame), else in sensor_msgs/Imu, else attitude in geometry_msgs/TransformStamped or in a PoseStamped on a
/// topic called pose that is no command or setpoint, with velocities in geometry_msgs/TwistStamped on a topic
/// called velocity_local; last on topics of a ground_truth. Times are those of the headers, where there are
/// any; where a header's clock jumps against the recorder's, the recorder's. Throws Error naming file, topic
/// and rule: two topics for one signal, a chosen topic or field that is not there, no bag.
BagSignals signalsFromBag(const std::string& path, const BagSignalOptions& options);

}  // namespace polyfly
