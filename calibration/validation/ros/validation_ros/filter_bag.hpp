#pragma once

#include <string>

#include "validation/filter_replay.hpp"
#include "validation_ros/topic_reader.hpp"

namespace polyfly_ros {

/// Topics of a safety filter; a name without a leading slash lies in the vehicle's namespace.
struct FilterTopics {
  std::string name_space;  ///< empty: found from the one topic of commands in the bag
  std::string odometry = "odometry";
  std::string wish = "wished/roll_pitch_yawrate_thrust";
  std::string status = "filter_status";  ///< may be missing
};

/// Reads what a safety filter received. What is damaged is left out and told in the log's remarks. Throws
/// polyfly::Error naming file, topic and rule when the file is missing, empty or no bag. Also when a topic is missing
/// or of another type.
polyfly::FilterLog readFilterBag(const std::string& path, const FilterTopics& topics,
                                 const BagProgress& progress = {});

}  // namespace polyfly_ros
