#include <exception>
#include <pluginlib/class_list_macros.hpp>

#include "polyfly_ros/node_shell.hpp"
#include "validation_ros/coverage_node.hpp"

namespace polyfly_ros {

/// Shell of CoverageNode.
class CoverageNodelet : public NodeShell<CoverageNode> {
  void onInit() override {
    try {
      NodeShell::onInit();
    } catch (const std::exception& error) {
      NODELET_FATAL("coverage does not start: %s", error.what());
      throw;
    }
  }
};

}  // namespace polyfly_ros

PLUGINLIB_EXPORT_CLASS(polyfly_ros::CoverageNodelet, nodelet::Nodelet)
