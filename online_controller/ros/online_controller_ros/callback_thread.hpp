#pragma once

#include <pthread.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "online_controller/realtime/baton.hpp"
#include "polyfly_base/range.hpp"

namespace polyfly_ros {

/// What the operating system may do for the control thread.
struct RealTimeOptions {
  int priority = -1;         ///< of SCHED_FIFO, 0: not real-time, -1: follows who publishes odometry
  int core = -1;             ///< runs on this processor only, -1: on any
  bool lock_memory = false;  ///< keeps the whole process in memory
  double poll = 0.0;         ///< share of the control period in which it looks for odometry without sleeping
  double rehearse = -1.0;  ///< so long before odometry is due the answer is rehearsed; 0: not, -1: usual [s]
};

template <class Options, class Visit>
void visitRealTimeOptions(Options& options, Visit&& visit) {
  visit("real_time/priority", options.priority, "of SCHED_FIFO", polyfly::Range{-1.0, 99.0});
  visit("real_time/core", options.core, "", polyfly::Range{-1.0, 1023.0});
  visit("real_time/lock_memory", options.lock_memory);
  visit("real_time/poll", options.poll, "of the control period", polyfly::Range{0.0, 1.0});
  visit("real_time/rehearse", options.rehearse, "s", polyfly::Range{-1.0, 0.01});
}

/// Whether odometry is answered in the thread that brings it (IN_FLIGHT.md), by `answer`, the value of
/// real_time/answer: publisher, thread (the control thread's), or auto, which is publisher unless an
/// option asks something of the control thread. Throws Error naming the option.
bool answersInPublisher(const std::string& answer, const RealTimeOptions& options);

/// How long before odometry is due the answer is rehearsed, 0: never [s]. Unless the options tell, half a
/// millisecond where it is answered in the thread that publishes it, on one of several processors.
double rehearsalLead(const RealTimeOptions& options, bool in_publisher);

/// Asks for the options on behalf of the calling thread. Says in one sentence each what was not permitted and
/// what would permit it, and goes on without; empty when all was granted.
std::string becomeRealTime(const RealTimeOptions& options);

/// The calling thread runs on that processor from now on, -1: on any that the process has. Empty, or in one
/// sentence why not.
std::string runOn(int core);

/// `who` has the real-time priority so many `steps` below that of `thread` from now on, but at least 1, where
/// that has one and `who` none. Empty, or in one sentence why not.
std::string runBelow(pid_t thread, int steps, pthread_t who);

/// A callback queue that a thread can watch without taking the lock that those who add to it need, or wait
/// for without being the one who calls.
class WatchedQueue : public ros::CallbackQueue {
 public:
  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner_id) override {
    ros::CallbackQueue::addCallback(callback, owner_id);
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      news_.store(true, std::memory_order_release);
    }
    added_.notify_one();
  }

  /// Whether something was added since the last call.
  bool takeNews() noexcept {
    return news_.load(std::memory_order_relaxed) && news_.exchange(false, std::memory_order_acquire);
  }

  /// Waits until something is added that no call has seen, at most so long [s].
  void awaitNews(double most) {
    std::unique_lock<std::mutex> lock(mutex_);
    added_.wait_for(lock, std::chrono::duration<double>(most), [this] { return takeNews(); });
  }

 private:
  std::mutex mutex_;
  std::condition_variable added_;
  std::atomic<bool> news_{false};
};

/// Tells the processor that this is a loop that waits.
void relax() noexcept;

/// The handle, its callbacks in that queue.
ros::NodeHandle onQueue(const ros::NodeHandle& handle, ros::CallbackQueue& queue);

/// A thread that serves a callback queue, and nothing else does. `begin` runs in it first. Ends with this.
class CallbackThread {
 public:
  /// How long the thread may sleep [s], at most as long as it is told; zero: look again at once. Called in
  /// it.
  using Sleep = std::function<double(double most)>;

  /// `baton`, where there is one, comes from whoever constructs this: the thread gives it, takes it for each
  /// callback, and keeps it when it ends.
  CallbackThread(WatchedQueue& queue, const char* name, std::function<void()> begin, Sleep sleep = {},
                 polyfly::Baton* baton = nullptr);
  CallbackThread(const CallbackThread&) = delete;
  CallbackThread& operator=(const CallbackThread&) = delete;
  ~CallbackThread();

  pthread_t handle() { return thread_.native_handle(); }

 private:
  void serve(WatchedQueue& queue, const Sleep& sleep, polyfly::Baton* baton) const;

  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace polyfly_ros
