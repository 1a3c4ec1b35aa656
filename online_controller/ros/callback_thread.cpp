#include "online_controller_ros/callback_thread.hpp"

#include <pthread.h>
#include <ros/ros.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

namespace polyfly_ros {
namespace {

constexpr double kPatience = 0.05;  // until a thread without work looks whether it shall end [s]

std::string refusal(const std::string& what, int error, const std::string& remedy) {
  return what + ": " + std::strerror(error) + "; goes on without. " + remedy + "\n";
}

}  // namespace

std::string becomeRealTime(const RealTimeOptions& options) {
  std::string said;
  if (options.lock_memory && mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    said += refusal(
        "real_time/lock_memory", errno,
        "Permitted to root and, as `USER - memlock unlimited` in /etc/security/limits.conf, to a user.");
  }
  if (options.core >= 0) {
    cpu_set_t cores;
    CPU_ZERO(&cores);
    CPU_SET(static_cast<std::size_t>(options.core), &cores);
    const int error = pthread_setaffinity_np(pthread_self(), sizeof cores, &cores);
    if (error != 0) {
      said += refusal("real_time/core " + std::to_string(options.core), error,
                      "There must be such a processor, and this process must be allowed to run on it.");
    }
  }
  if (options.priority > 0) {
    sched_param parameters{};
    parameters.sched_priority = options.priority;
    const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
    if (error != 0) {
      said +=
          refusal("real_time/priority " + std::to_string(options.priority), error,
                  "Permitted to root and, as `USER - rtprio 99` in /etc/security/limits.conf, to a user.");
    }
  }
  return said;
}

ros::NodeHandle onQueue(const ros::NodeHandle& handle, ros::CallbackQueue& queue) {
  ros::NodeHandle copy(handle);
  copy.setCallbackQueue(&queue);
  return copy;
}

void relax() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ volatile("yield");
#endif
}

CallbackThread::CallbackThread(WatchedQueue& queue, const char* name, std::function<void()> begin,
                               Sleep sleep)
    : thread_([this, &queue, begin = std::move(begin), sleep = std::move(sleep)] {
        if (begin) begin();
        serve(queue, sleep);
      }) {
  pthread_setname_np(thread_.native_handle(), name);
}

void CallbackThread::serve(WatchedQueue& queue, const Sleep& sleep) const {
  while (!stopping_ && ros::ok()) {
    const double patience = sleep ? sleep(kPatience) : kPatience;
    if (patience > 0.0) {
      queue.callAvailable(ros::WallDuration(patience));
    } else if (queue.takeNews()) {
      queue.callAvailable();
    } else {
      relax();
    }
  }
}

CallbackThread::~CallbackThread() {
  stopping_ = true;
  thread_.join();
}

}  // namespace polyfly_ros
