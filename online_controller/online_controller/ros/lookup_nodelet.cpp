#include <pluginlib/class_list_macros.hpp>

#include "online_controller_ros/lookup_node.hpp"
#include "polyfly_ros/node_shell.hpp"

namespace online_controller {

class LookupNodelet : public polyfly_ros::NodeShell<polyfly_ros::LookupNode> {};

}  // namespace online_controller

PLUGINLIB_EXPORT_CLASS(online_controller::LookupNodelet, nodelet::Nodelet)
