#pragma once

#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "polyfly_ros/option_table.hpp"

namespace polyfly_ros {

/// What a start under the names of mav_control_rw has found.
struct LegacyParameters {
  std::string taken;                ///< "theirs -> ours", separated by commas
  std::vector<std::string> unread;  ///< "theirs, theirs: why not"
  LegacyNames names;                ///< under which options can be changed in flight besides ours
};

/// Lets a launch file and a YAML file written for mav_control_rw start this controller. Its private parameters under
/// that package's names are set under ours, unless ours is set too. `law` is the one to fly, `linear` or `nonlinear`,
/// unless the parameter law says otherwise. What was set so is noted below `adopted`, and set anew where theirs has
/// changed since. Throws polyfly::Error naming one of theirs that has another type.
LegacyParameters importLegacyParameters(const ros::NodeHandle& private_handle, const std::string& law);

}  // namespace polyfly_ros
