#pragma once

#include <ros/callback_queue.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>

#include "online_controller/realtime/try_lock.hpp"
#include "polyfly_ros/guarded_queue.hpp"

namespace polyfly_ros {

/// A callback queue that a thread can wait for before it locks and calls. Its callbacks are guarded (guarded_queue.hpp).
class WaitableQueue : public ros::CallbackQueue {
 public:
  using Clock = std::chrono::steady_clock;

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner_id) override;

  /// Returns when there is a callback, or at `time`.
  void waitUntil(Clock::time_point time);

 private:
  std::mutex mutex_;
  std::condition_variable added_;
};

/// The only thread that serves a callback queue. Ends with this.
class CallbackThread {
 public:
  struct Tasks {
    /// Called first.
    std::function<void()> begin;
    /// Called once in each period, guarded as callbacks are.
    std::function<void()> tick;
    /// Period of wall time [s].
    double period = 0.05;
    /// Lock that is held during each callback and each tick.
    polyfly::TryLock* lock = nullptr;
  };

  CallbackThread(WaitableQueue& queue, const char* name, Tasks tasks);
  CallbackThread(const CallbackThread&) = delete;
  CallbackThread& operator=(const CallbackThread&) = delete;
  ~CallbackThread();

 private:
  void serve(WaitableQueue& queue, const Tasks& tasks) const;

  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace polyfly_ros
