#pragma once

#include <mavros_msgs/AttitudeTarget.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/Joy.h>
#include <std_msgs/Bool.h>

#include "excitation/flight.hpp"
#include "polyfly_ros/guarded_queue.hpp"

namespace polyfly_ros {

/// Flies an excitation plan: odometry in, commands out; see calibration/excitation/README.md for topics and
/// parameters. A shell around ExcitationFlight: what it commands carries the stamp of the odometry that it
/// answers, so that a recorded bag is complete.
class ExciteNode {
 public:
  /// Reads `plan` (path of the YAML file) and the options below the private namespace. Throws polyfly::Error.
  ExciteNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle);

 private:
  void onOdometry(const nav_msgs::Odometry::ConstPtr& message);
  void onJoy(const sensor_msgs::Joy::ConstPtr& message);
  void onEngaged(const std_msgs::Bool::ConstPtr& message);
  void onTimer();
  void publishCommand(const polyfly::AttitudeCommand& command, const ros::Time& stamp, double yaw);
  void publishState();

  GuardedQueue queue_;
  polyfly::ExcitationOptions options_;
  bool engaged_ = false;
  polyfly::ExcitationFlight flight_;  // after what is read with its plan
  double last_yaw_ = 0.0;
  polyfly::ExcitationState told_state_ = polyfly::ExcitationState::kWaiting;
  int told_manoeuvre_ = -2;
  ros::Publisher command_publisher_;
  ros::Publisher attitude_publisher_;
  ros::Publisher reference_publisher_;
  ros::Publisher state_publisher_;
  ros::Subscriber odometry_subscriber_;
  ros::Subscriber joy_subscriber_;
  ros::Subscriber engaged_subscriber_;
  ros::Timer timer_;
};

}  // namespace polyfly_ros
