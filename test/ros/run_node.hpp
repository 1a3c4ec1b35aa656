#pragma once

#include <ros/ros.h>

#include "polyfly_base/error.hpp"

namespace polyfly_ros {

/// Runs the class of a nodelet as a process of its own.
template <class Node>
int runNode(int argc, char** argv, const char* name) {
  ros::init(argc, argv, name);
  try {
    Node node(ros::NodeHandle(), ros::NodeHandle("~"));
    ros::spin();
  } catch (const polyfly::Error& error) {
    ROS_FATAL_STREAM(error.what());
    return 1;
  }
  return 0;
}

}  // namespace polyfly_ros
