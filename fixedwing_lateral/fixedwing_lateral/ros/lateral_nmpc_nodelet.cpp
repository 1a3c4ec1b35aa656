#include <pluginlib/class_list_macros.hpp>

#include "fixedwing_lateral_ros/lateral_node.hpp"
#include "polyfly_ros/node_shell.hpp"

namespace fixedwing_lateral {

class LateralNmpc : public polyfly_ros::NodeShell<polyfly_ros::LateralNode> {};

}  // namespace fixedwing_lateral

PLUGINLIB_EXPORT_CLASS(fixedwing_lateral::LateralNmpc, nodelet::Nodelet)
