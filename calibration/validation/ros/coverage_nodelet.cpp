#include <pluginlib/class_list_macros.hpp>

#include "polyfly_ros/node_shell.hpp"
#include "validation_ros/coverage_node.hpp"

namespace polyfly_ros {

class CoverageNodelet : public NodeShell<CoverageNode> {};

}  // namespace polyfly_ros

PLUGINLIB_EXPORT_CLASS(polyfly_ros::CoverageNodelet, nodelet::Nodelet)
