#pragma once

#include <mav_msgs/RollPitchYawrateThrust.h>
#include <nav_msgs/Odometry.h>
#include <online_controller/CommandFilterStatus.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/steady_timer.h>
#include <ros/subscriber.h>

#include <memory>

#include "online_controller/flight/command_filter.hpp"
#include "polyfly_ros/guarded_queue.hpp"

namespace polyfly_ros {

/// The safety filter on topics: takes `wished/roll_pitch_yawrate_thrust` and `odometry`, sends
/// `command/roll_pitch_yawrate_thrust` and `filter_status`. Each command is answered at once, with the last
/// odometry. Where no command comes for silence_periods, it filters level flight once in each period. All
/// callbacks must be served by one thread.
class CommandFilterNode {
 public:
  /// Reads parameters and maps. Throws Error, after logging it.
  CommandFilterNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle);

 private:
  void onOdometry(const nav_msgs::Odometry& message);
  void onWish(const mav_msgs::RollPitchYawrateThrust& message);
  void onTimer();
  bool hasState() const;
  void answer(const polyfly::AttitudeCommand& wish, const std_msgs::Header& header);
  void report(const polyfly::FilterReport& report, const std_msgs::Header& header);

  GuardedQueue queue_;
  std::unique_ptr<polyfly::CommandFilter> filter_;
  double silence_ = 0.0;  // [s]
  double stale_ = 0.0;    // [s]
  polyfly::VehicleState state_;
  // By the steady clock, which goes on where simulated time stands.
  ros::SteadyTime state_time_;
  ros::SteadyTime answer_time_;
  ros::Time answered_stamp_;
  bool answered_ = false;
  online_controller::CommandFilterStatus status_;
  ros::Publisher command_publisher_;
  ros::Publisher status_publisher_;
  ros::Subscriber odometry_subscriber_;
  ros::Subscriber wish_subscriber_;
  ros::SteadyTimer timer_;
};

}  // namespace polyfly_ros
