#pragma once

#include <string>

#include "calibration/flight_log.hpp"

namespace polyfly_ros {

/// Topics of a flight; a name without a leading slash lies in the vehicle's namespace.
struct BagTopics {
  std::string name_space;  ///< empty: found from the one topic of commands in the bag
  std::string odometry = "odometry";
  std::string trajectory = "command/trajectory";
  std::string pose = "command/pose";
  std::string command = "command/roll_pitch_yawrate_thrust";
  std::string status = "controller_status";              ///< may be missing
  std::string disturbance = "ground_truth/disturbance";  ///< may be missing
};

/// Reads a flight. Odometry, commands and one of trajectory and pose must be there. Throws polyfly::Error
/// naming file, topic and rule when the file is missing, empty, no bag, cut off or damaged, when a topic is
/// missing or of another type, or when a message breaks the rules of online_controller_ros/conversions.hpp.
polyfly::FlightLog readBag(const std::string& path, const BagTopics& topics);

/// As readBag, for files of unknown health: rosbag itself reads beyond its buffers on some damaged bags, so a
/// child process reads the file first, and its crash becomes an Error. For programs of a single thread.
polyfly::FlightLog readBagGuarded(const std::string& path, const BagTopics& topics);

}  // namespace polyfly_ros
