#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "online_controller_ros/command_filter_node.hpp"

namespace online_controller {

class SafetyFilter : public nodelet::Nodelet {
  void onInit() override {
    node_ = std::make_unique<polyfly_ros::CommandFilterNode>(getNodeHandle(), getPrivateNodeHandle());
  }

  std::unique_ptr<polyfly_ros::CommandFilterNode> node_;
};

}  // namespace online_controller

PLUGINLIB_EXPORT_CLASS(online_controller::SafetyFilter, nodelet::Nodelet)
