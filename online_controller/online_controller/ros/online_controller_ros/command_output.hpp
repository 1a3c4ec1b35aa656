#pragma once

#include <mav_msgs/RollPitchYawrateThrust.h>
#include <mavros_msgs/AttitudeTarget.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <std_msgs/Header.h>

#include <optional>
#include <vector>

#include "online_controller/types/node_options.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller/types/thrust_curve.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly_ros {

/// Publishes commands. Each message is made beforehand and shared: neighbours in the same nodelet manager
/// get it without a copy, so it does not change afterwards.
class CommandOutput {
 public:
  /// Throws Error when the thrust curve does not fit the limits.
  CommandOutput(ros::NodeHandle& handle, const polyfly::OutputOptions& options,
                const polyfly::MultirotorOptions& vehicle);

  /// `yaw` is that of the vehicle [rad]. Where it is not finite, as with an odometry that is none, the
  /// last one counts; until there is one, no AttitudeTarget is sent.
  void publish(const polyfly::AttitudeCommand& command, const std_msgs::Header& header, double yaw);

  /// Makes the next messages, when those before are out. publish() does without it too.
  void prepare();

 private:
  ros::Publisher thrust_publisher_;
  mav_msgs::RollPitchYawrateThrust::Ptr next_thrust_;
  mavros_msgs::AttitudeTarget::Ptr next_target_;
  ros::Publisher target_publisher_;
  std::optional<polyfly::ThrustCurve> curve_;
  double yaw_;
};

}  // namespace polyfly_ros
