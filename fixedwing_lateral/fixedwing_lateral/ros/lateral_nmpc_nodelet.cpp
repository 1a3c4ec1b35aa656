#include <nodelet/nodelet.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "fixedwing_lateral_ros/lateral_node.hpp"

namespace fixedwing_lateral {

class LateralNmpc : public nodelet::Nodelet {
  void onInit() override {
    node_ = std::make_unique<polyfly_ros::LateralNode>(getNodeHandle(), getPrivateNodeHandle());
  }

  std::unique_ptr<polyfly_ros::LateralNode> node_;
};

}  // namespace fixedwing_lateral

PLUGINLIB_EXPORT_CLASS(fixedwing_lateral::LateralNmpc, nodelet::Nodelet)
