#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "online_controller_ros/controller_node.hpp"

namespace online_controller {

class ExplicitMpc : public nodelet::Nodelet {
  void onInit() override {
    node_ = std::make_unique<polyfly_ros::ControllerNode>(getNodeHandle(), getPrivateNodeHandle());
  }

  std::unique_ptr<polyfly_ros::ControllerNode> node_;
};

}  // namespace online_controller

PLUGINLIB_EXPORT_CLASS(online_controller::ExplicitMpc, nodelet::Nodelet)
