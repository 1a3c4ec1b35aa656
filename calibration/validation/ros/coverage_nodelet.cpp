#include <nodelet/nodelet.h>

#include <exception>
#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "validation_ros/coverage_node.hpp"

namespace polyfly_ros {

/// Shell of CoverageNode.
class CoverageNodelet : public nodelet::Nodelet {
  void onInit() override {
    try {
      node_ = std::make_unique<CoverageNode>(getNodeHandle(), getPrivateNodeHandle());
    } catch (const std::exception& error) {
      NODELET_FATAL("coverage does not start: %s", error.what());
      throw;
    }
  }

  std::unique_ptr<CoverageNode> node_;
};

}  // namespace polyfly_ros

PLUGINLIB_EXPORT_CLASS(polyfly_ros::CoverageNodelet, nodelet::Nodelet)
