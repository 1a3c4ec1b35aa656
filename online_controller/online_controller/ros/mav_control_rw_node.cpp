// The controller under the names of mav_control_rw's nodes: POLYFLY_LAW and POLYFLY_NODE tell which.
#include <ros/ros.h>

#include <exception>

#include "online_controller/types/options.hpp"
#include "online_controller_ros/controller_node.hpp"
#include "online_controller_ros/legacy_parameters.hpp"

int main(int argc, char** argv) try {
  ros::init(argc, argv, POLYFLY_NODE);
  const ros::NodeHandle private_handle("~");
  if (!private_handle.hasParam("law")) private_handle.setParam("law", POLYFLY_LAW);
  const double gravity = private_handle.param("vehicle/gravity", polyfly::MultirotorOptions{}.gravity);
  const polyfly_ros::ControllerNode node(ros::NodeHandle(), private_handle,
                                         polyfly_ros::legacyNames(POLYFLY_LAW, gravity));
  ros::spin();
} catch (const std::exception&) {
  // The node has logged the reason.
  return 1;
}
