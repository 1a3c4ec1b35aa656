#pragma once

#include <mavros_msgs/ExtendedState.h>
#include <mavros_msgs/State.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>

#include "online_controller/flight/autopilot.hpp"

namespace polyfly_ros {

/// What the topics `mavros/state` and `mavros/extended_state` say of the vehicle.
class AutopilotInput {
 public:
  explicit AutopilotInput(ros::NodeHandle& handle);

  /// At the time `now` [s]. Fresh where the autopilot is connected and both messages are at most 2 s old.
  polyfly::AutopilotReport report(double now) const noexcept;

 private:
  mavros_msgs::State state_;
  mavros_msgs::ExtendedState extended_;
  ros::Subscriber state_subscriber_;
  ros::Subscriber extended_subscriber_;
};

}  // namespace polyfly_ros
