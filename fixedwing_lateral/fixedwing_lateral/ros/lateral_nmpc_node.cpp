#include <ros/ros.h>

#include <exception>

#include "fixedwing_lateral_ros/lateral_node.hpp"

int main(int argc, char** argv) try {
  ros::init(argc, argv, "lateral_nmpc");
  const polyfly_ros::LateralNode node(ros::NodeHandle(), ros::NodeHandle("~"));
  ros::spin();
} catch (const std::exception& error) {
  ROS_FATAL("lateral guidance ends: %s", error.what());
  return 1;
}
