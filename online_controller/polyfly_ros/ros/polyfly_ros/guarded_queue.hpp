#pragma once

#include <ros/callback_queue.h>
#include <ros/node_handle.h>

#include <cstdint>

namespace polyfly_ros {

/// A callback that calls this one. An exception would end the process, with all nodelets in it: it becomes an error message
/// instead.
ros::CallbackInterfacePtr guarded(const ros::CallbackInterfacePtr& callback);

/// A queue for a spinner of its own. Its callbacks are guarded.
class ThreadQueue : public ros::CallbackQueue {
 public:
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner_id) override {
    ros::CallbackQueue::addCallback(guarded(callback), owner_id);
  }
};

/// Hands the callbacks of a node to the queue of its node handle, guarded. Must outlive what it is a queue of.
class GuardedQueue : public ros::CallbackQueueInterface {
 public:
  explicit GuardedQueue(const ros::NodeHandle& handle) : queue_(*handle.getCallbackQueue()) {}

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner_id) override {
    queue_.addCallback(guarded(callback), owner_id);
  }
  void removeByID(std::uint64_t owner_id) override { queue_.removeByID(owner_id); }

 private:
  ros::CallbackQueueInterface& queue_;
};

/// A handle of the same namespace whose callbacks go to `queue`.
ros::NodeHandle onQueue(const ros::NodeHandle& handle, ros::CallbackQueueInterface& queue);

}  // namespace polyfly_ros
