#include <ros/ros.h>

#include <exception>

#include "online_controller_ros/command_filter_node.hpp"

int main(int argc, char** argv) try {
  ros::init(argc, argv, "safety_filter");
  const polyfly_ros::CommandFilterNode node(ros::NodeHandle(), ros::NodeHandle("~"));
  ros::spin();
} catch (const std::exception&) {
  // The node has logged the reason.
  return 1;
}
