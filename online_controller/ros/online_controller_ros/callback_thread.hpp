#pragma once

#include <ros/callback_queue.h>
#include <ros/node_handle.h>

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "mpc_core/range.hpp"

namespace polyfly_ros {

/// What the operating system may do for the control thread.
struct RealTimeOptions {
  int priority = 0;          ///< of SCHED_FIFO, 0: not real-time
  int core = -1;             ///< runs on this processor only, -1: on any
  bool lock_memory = false;  ///< keeps the whole process in memory
};

template <class Options, class Visit>
void visitRealTimeOptions(Options& options, Visit&& visit) {
  visit("real_time/priority", options.priority, "of SCHED_FIFO", polyfly::Range{0.0, 99.0});
  visit("real_time/core", options.core, "", polyfly::Range{-1.0, 1023.0});
  visit("real_time/lock_memory", options.lock_memory);
}

/// Asks for the options on behalf of the calling thread. Says in one sentence each what was not permitted and
/// what would permit it, and goes on without; empty when all was granted.
std::string becomeRealTime(const RealTimeOptions& options);

/// The handle, its callbacks in that queue.
ros::NodeHandle onQueue(const ros::NodeHandle& handle, ros::CallbackQueue& queue);

/// A thread that serves a callback queue, and nothing else does. `begin` runs in it first. Ends with this.
class CallbackThread {
 public:
  CallbackThread(ros::CallbackQueue& queue, const char* name, std::function<void()> begin);
  CallbackThread(const CallbackThread&) = delete;
  CallbackThread& operator=(const CallbackThread&) = delete;
  ~CallbackThread();

 private:
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace polyfly_ros
