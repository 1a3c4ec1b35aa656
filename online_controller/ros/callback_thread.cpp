#include "online_controller_ros/callback_thread.hpp"

#include <pthread.h>
#include <ros/ros.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "polyfly_base/error.hpp"

namespace polyfly_ros {
namespace {

constexpr double kPatience = 0.05;     // until a thread without work looks whether it shall end [s]
constexpr double kUsualLead = 0.0005;  // of a rehearsal [s]

std::string refusal(const std::string& what, int error, const std::string& remedy) {
  return what + ": " + std::strerror(error) + "; goes on without. " + remedy + "\n";
}

cpu_set_t processCores() noexcept {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  sched_getaffinity(getpid(), sizeof cores, &cores);
  return cores;
}

std::string askForPriority(pthread_t thread, int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int error = pthread_setschedparam(thread, SCHED_FIFO, &parameters);
  if (error == 0) return {};
  return refusal("real_time/priority " + std::to_string(priority), error,
                 "Permitted to root and, as `USER - rtprio 99` in /etc/security/limits.conf, to a user.");
}

/// Whether there was one.
bool callOne(WatchedQueue& queue, polyfly::Baton* baton) {
  const polyfly::BatonHold hold(baton);
  return queue.callOne() == ros::CallbackQueue::Called;
}

}  // namespace

std::string becomeRealTime(const RealTimeOptions& options) {
  std::string said;
  if (options.lock_memory && mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    said += refusal(
        "real_time/lock_memory", errno,
        "Permitted to root and, as `USER - memlock unlimited` in /etc/security/limits.conf, to a user.");
  }
  if (options.core >= 0) said += runOn(options.core);
  if (options.rehearse > 0.0) prctl(PR_SET_TIMERSLACK, 1UL);  // [ns]: to be awake in time
  if (options.priority > 0) said += askForPriority(pthread_self(), options.priority);
  return said;
}

std::string runBelow(pid_t thread, int steps, pthread_t who) {
  const auto isRealTime = [](int policy) { return policy == SCHED_FIFO || policy == SCHED_RR; };
  sched_param above{}, own{};
  int own_policy = SCHED_OTHER;
  if (!isRealTime(sched_getscheduler(thread)) || sched_getparam(thread, &above) != 0 ||
      pthread_getschedparam(who, &own_policy, &own) != 0 || own_policy != SCHED_OTHER)
    return {};
  return askForPriority(who, std::max(1, above.sched_priority - steps));
}

std::string runOn(int core) {
  cpu_set_t cores = processCores();
  if (core >= 0) {
    CPU_ZERO(&cores);
    CPU_SET(static_cast<std::size_t>(core), &cores);
  }
  const int error = pthread_setaffinity_np(pthread_self(), sizeof cores, &cores);
  if (error == 0) return {};
  return refusal("real_time/core " + std::to_string(core), error,
                 "There must be such a processor, and this process must be allowed to run on it.");
}

bool answersInPublisher(const std::string& answer, const RealTimeOptions& options) {
  if (answer == "thread") return false;
  if (answer == "auto") return options.priority <= 0 && options.core < 0 && options.poll == 0.0;
  if (answer != "publisher")
    throw polyfly::Error("real_time/answer: must be one of auto, publisher, thread, got '" + answer + "'");
  if (options.poll > 0.0)
    throw polyfly::Error(
        "real_time/poll: has no sense with real_time/answer publisher: the control thread waits for nothing");
  return true;
}

double rehearsalLead(const RealTimeOptions& options, bool in_publisher) {
  if (options.rehearse >= 0.0) return options.rehearse;
  const cpu_set_t cores = processCores();
  return in_publisher && CPU_COUNT(&cores) > 1 ? kUsualLead : 0.0;
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
                               Sleep sleep, polyfly::Baton* baton)
    : thread_([this, &queue, begin = std::move(begin), sleep = std::move(sleep), baton] {
        if (begin) begin();
        if (baton != nullptr) baton->give();
        serve(queue, sleep, baton);
        if (baton != nullptr) baton->take();
      }) {
  pthread_setname_np(thread_.native_handle(), name);
}

void CallbackThread::serve(WatchedQueue& queue, const Sleep& sleep, polyfly::Baton* baton) const {
  while (!stopping_ && ros::ok()) {
    const double patience = sleep ? sleep(kPatience) : kPatience;
    if (patience > 0.0) {
      queue.awaitNews(patience);
    } else if (!queue.takeNews()) {
      relax();
      continue;
    }
    while (!stopping_ && callOne(queue, baton)) {
    }
  }
}

CallbackThread::~CallbackThread() {
  stopping_ = true;
  thread_.join();
}

}  // namespace polyfly_ros
