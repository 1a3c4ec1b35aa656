#include <ros/ros.h>

#include <exception>

#include "online_controller_ros/controller_node.hpp"

int main(int argc, char** argv) try {
  ros::init(argc, argv, "explicit_mpc");
  const polyfly_ros::ControllerNode node(ros::NodeHandle(), ros::NodeHandle("~"));
  ros::spin();
} catch (const std::exception&) {
  // The node has logged the reason.
  return 1;
}
