#include <ros/ros.h>

#include <iostream>
#include <string>

#include "polyfly_base/error.hpp"
#include "validation_ros/coverage_node.hpp"

namespace {

constexpr const char* kHelp =
    "Tells in flight how the regions of the maps in use are covered, as a ROS node.\n"
    "usage: coverage [_PARAMETER:=VALUE ...]   the node; calibration/README.md lists its parameters\n"
    "       coverage --help\n";

}  // namespace

int main(int argc, char** argv) {
  if (argc >= 2 && (std::string(argv[1]) == "--help" || std::string(argv[1]) == "-h")) {
    std::cout << kHelp << std::flush;
    return std::cout ? 0 : 2;
  }
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
