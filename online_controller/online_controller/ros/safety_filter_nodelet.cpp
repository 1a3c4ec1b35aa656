#include <pluginlib/class_list_macros.hpp>

#include "online_controller_ros/command_filter_node.hpp"
#include "polyfly_ros/node_shell.hpp"

namespace online_controller {

class SafetyFilter : public polyfly_ros::NodeShell<polyfly_ros::CommandFilterNode> {};

}  // namespace online_controller

PLUGINLIB_EXPORT_CLASS(online_controller::SafetyFilter, nodelet::Nodelet)
