#pragma once

#include <ros/node_handle.h>

#include <string>

namespace polyfly_ros {

/// Lets a launch file and a YAML file written for mav_control_rw start this controller: what stands there in
/// its private parameters under that package's names is set under ours, unless ours is set too. `law` is the
/// one to fly, `linear` or `nonlinear`, unless the parameter law says otherwise. Returns what was taken and
/// what has no counterpart, for the log.
std::string adoptForeignParameters(const ros::NodeHandle& private_handle, const std::string& law);

}  // namespace polyfly_ros
