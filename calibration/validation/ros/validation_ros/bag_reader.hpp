#pragma once

#include <string>
#include <vector>

#include "validation/flight_log.hpp"
#include "validation_ros/topic_reader.hpp"

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
  std::string parameters = "parameters_in_force";        ///< of any node in the namespace; may be missing
};

/// Reads a flight. Odometry, commands and one of trajectory and pose must be there. What is damaged is left out and
/// told in the log's remarks. A bag that was cut off or has no index gives its complete chunks (bags/scan_bag.hpp).
/// Throws polyfly::Error naming file, topic and rule when the file is missing, empty or no bag. Also when a topic is
/// missing or of another type, or when a message breaks the rules of online_controller_ros/conversions.hpp.
/// A recording that was split is read from its pieces, in order.
polyfly::FlightLog readBag(const std::vector<std::string>& pieces, const BagTopics& topics,
                           const BagProgress& progress = {});

inline polyfly::FlightLog readBag(const std::string& path, const BagTopics& topics,
                                  const BagProgress& progress = {}) {
  return readBag(std::vector<std::string>{path}, topics, progress);
}

/// The bags by recording, in the order of their first pieces. Throws Error as readBag does.
std::vector<std::vector<std::string>> recordingsOf(const std::vector<std::string>& bags);

}  // namespace polyfly_ros
