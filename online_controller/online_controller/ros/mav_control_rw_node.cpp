// The controller under the names of mav_control_rw's nodes: POLYFLY_LAW and POLYFLY_NODE tell which.
#include <ros/ros.h>

#include <exception>

#include "online_controller_ros/controller_node.hpp"
#include "online_controller_ros/legacy_parameters.hpp"

namespace {

polyfly_ros::LegacyParameters importParameters(const ros::NodeHandle& private_handle) try {
  return polyfly_ros::importLegacyParameters(private_handle, POLYFLY_LAW);
} catch (const std::exception& error) {
  ROS_FATAL("%s does not start: %s", POLYFLY_NODE, error.what());
  throw;
}

}  // namespace

int main(int argc, char** argv) try {
  ros::init(argc, argv, POLYFLY_NODE);
  const ros::NodeHandle private_handle("~");
  const auto legacy = importParameters(private_handle);
  if (!legacy.taken.empty()) ROS_INFO("parameters of mav_control_rw: %s", legacy.taken.c_str());
  for (const std::string& text : legacy.unread)
    ROS_WARN("parameters of mav_control_rw not read: %s", text.c_str());
  const polyfly_ros::ControllerNode node(ros::NodeHandle(), private_handle, legacy.names);
  ros::spin();
} catch (const std::exception&) {
  // The node has logged the reason.
  return 1;
}
