#pragma once

#include <mav_msgs/RollPitchYawrateThrust.h>
#include <nav_msgs/Odometry.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "online_controller/realtime/baton.hpp"
#include "online_controller/types/types.hpp"
#include "online_controller_ros/direct_queue.hpp"

namespace polyfly_ros {

/// Goes the way from publish(odometry) to the receiver of a command with two topics of its own,
/// ~rehearsal/odometry and ~rehearsal/command, so that roscpp's instructions and what all topics share lie in
/// the caches of this processor. Nobody else need listen to them, and what others publish there is ignored.
class TopicRehearsal {
 public:
  /// What an answer does between the two messages: takes the odometry, and calls answer().
  using Within = std::function<void(const nav_msgs::Odometry&)>;

  TopicRehearsal(const ros::NodeHandle& private_handle, Within within);
  TopicRehearsal(const TopicRehearsal&) = delete;
  TopicRehearsal& operator=(const TopicRehearsal&) = delete;

  /// Publishes an odometry that looks like one of `frame`; `within` runs before this returns.
  void publish(const ros::Time& stamp, const std::string& frame);

  /// Publishes the command; it has been received when this returns.
  void answer(const polyfly::AttitudeCommand& command, const std_msgs::Header& header);

 private:
  Within within_;
  std::atomic<std::thread::id> speaker_{};  // who is in publish()
  ros::CallbackQueue others_;               // where both queues leave what comes otherwise; nobody serves it
  polyfly::Baton odometry_baton_, command_baton_;
  DirectQueue odometry_queue_{odometry_baton_, others_};
  DirectQueue command_queue_{command_baton_, others_};
  ros::NodeHandle handle_;
  ros::Publisher odometry_publisher_, command_publisher_;
  ros::Subscriber odometry_subscriber_, command_subscriber_;  // these end first
};

}  // namespace polyfly_ros
