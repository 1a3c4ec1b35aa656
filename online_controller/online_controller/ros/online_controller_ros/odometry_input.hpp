#pragma once

#include <nav_msgs/Odometry.h>
#include <ros/message_event.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>

#include <functional>

#include "online_controller/realtime/try_lock.hpp"
#include "online_controller_ros/callback_thread.hpp"
#include "online_controller_ros/flight_snapshot.hpp"
#include "online_controller_ros/inline_callback_queue.hpp"

namespace polyfly_ros {

/// What else runs in the process.
enum class ProcessKind {
  kNodeletManager,  ///< other nodelets, which may publish odometry
  kStandalone,      ///< nothing: odometry comes over connections only
};

/// Brings odometry to the controller, in order. Each message is answered either inline, in the thread that brings it,
/// or in the control thread. Inline are the messages of the same process and, in a process of its own, those of
/// connections. Each is inline only if the lock is free (IN_FLIGHT.md).
class OdometryInput {
 public:
  struct Callbacks {
    std::function<void(const nav_msgs::Odometry&)> answer;  ///< with the lock held, in either thread
    std::function<void()> finish;  ///< after it, with the lock held, in the control thread
  };

  /// Subscribes. `queue` is the control thread's. `in_publisher`: whether any message is answered inline.
  /// `record` counts those that had to wait for the lock. Keeps references to the last three.
  OdometryInput(const ros::NodeHandle& handle, bool in_publisher, ProcessKind process, Callbacks callbacks,
                polyfly::TryLock& lock, WaitableQueue& queue, FlightRecord& record);
  OdometryInput(const OdometryInput&) = delete;
  OdometryInput& operator=(const OdometryInput&) = delete;

 private:
  using Event = ros::MessageEvent<const nav_msgs::Odometry>;

  void onOdometry(const Event& event);
  void answerInline(const Event& event);
  void onFollowUp();

  bool in_publisher_;
  ProcessKind process_;
  Callbacks callbacks_;
  FlightRecord& record_;
  IsIntraProcess is_intra_process_;
  // Message that the follow-up has to answer.
  nav_msgs::Odometry::ConstPtr deferred_;
  InlineCallbackQueue inline_queue_;
  ros::Subscriber subscriber_;
};

}  // namespace polyfly_ros
