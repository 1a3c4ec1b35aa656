#include <ros/ros.h>

#include "polyfly_base/error.hpp"
#include "validation_ros/coverage_node.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "coverage");
  try {
    polyfly_ros::CoverageNode node(ros::NodeHandle(), ros::NodeHandle("~"));
    ros::spin();
  } catch (const polyfly::Error& error) {
    ROS_FATAL_STREAM("coverage does not start: " << error.what());
    return 1;
  }
  return 0;
}
