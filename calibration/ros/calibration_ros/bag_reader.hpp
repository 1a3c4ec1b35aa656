#pragma once

#include <functional>
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

/// Told the share of the file that was read, 0..1.
using BagProgress = std::function<void(double)>;

/// Reads a flight. Odometry, commands and one of trajectory and pose must be there. What is damaged is left
/// out and told in the log's remarks: a bag that was cut off or has no index gives its whole chunks
/// (bags/scan_bag.hpp). Throws polyfly::Error naming file, topic and rule when the file is missing, empty or
/// no bag, when a topic is missing or of another type, or when a message breaks the rules of
/// online_controller_ros/conversions.hpp.
polyfly::FlightLog readBag(const std::string& path, const BagTopics& topics,
                           const BagProgress& progress = {});

}  // namespace polyfly_ros
