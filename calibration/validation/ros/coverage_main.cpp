#include <ros/ros.h>

#include <exception>

#include "validation_ros/coverage_node.hpp"

int main(int argc, char** argv) try {
  ros::init(argc, argv, "coverage");
  const polyfly_ros::CoverageNode node(ros::NodeHandle(), ros::NodeHandle("~"));
  ros::spin();
} catch (const std::exception&) {
  // The node has logged the reason.
  return 1;
}
