#include <ros/ros.h>

#include <exception>

#include "online_controller_ros/lookup_node.hpp"

int main(int argc, char** argv) try {
  ros::init(argc, argv, "lookup");
  const polyfly_ros::LookupNode node(ros::NodeHandle(), ros::NodeHandle("~"));
  ros::spin();
} catch (const std::exception&) {
  // The node has logged the reason.
  return 1;
}
