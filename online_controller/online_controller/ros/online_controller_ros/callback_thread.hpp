#pragma once

#include <ros/callback_queue.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>

#include "polyfly_ros/guarded_queue.hpp"

namespace polyfly_ros {

/// A callback queue for one thread. Its callbacks are guarded (guarded_queue.hpp).
class ThreadQueue : public ros::CallbackQueue {
 public:
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner_id) override {
    ros::CallbackQueue::addCallback(guarded(callback), owner_id);
  }
};

/// The only thread that serves a callback queue. Ends with this.
class CallbackThread {
 public:
  /// `tick` is called once in each `period` of wall time [s], guarded as callbacks are. Keeps a reference to the queue.
  CallbackThread(ThreadQueue& queue, const char* name, std::function<void()> tick = {}, double period = 0.05);
  CallbackThread(const CallbackThread&) = delete;
  CallbackThread& operator=(const CallbackThread&) = delete;
  ~CallbackThread();

 private:
  void serve(ThreadQueue& queue, const std::function<void()>& tick, double period) const;

  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace polyfly_ros
