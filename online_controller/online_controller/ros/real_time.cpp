#include "online_controller_ros/real_time.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

#include "polyfly_base/error.hpp"

namespace polyfly_ros {
namespace {

std::string refusal(const std::string& what, int error, const std::string& remedy) {
  return what + ": " + std::strerror(error) + "; goes on without. " + remedy + "\n";
}

std::string lockMemory() {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) == 0) return {};
  return refusal(
      "real_time/lock_memory", errno,
      "Permitted to root and, as `USER - memlock unlimited` in /etc/security/limits.conf, to a user.");
}

std::string runOn(int core) {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  CPU_SET(static_cast<std::size_t>(core), &cores);
  const int error = pthread_setaffinity_np(pthread_self(), sizeof cores, &cores);
  if (error == 0) return {};
  return refusal("real_time/core " + std::to_string(core), error,
                 "There must be such a processor, and this process must be allowed to run on it.");
}

std::string takePriority(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (error == 0) return {};
  return refusal("real_time/priority " + std::to_string(priority), error,
                 "Permitted to root and, as `USER - rtprio 99` in /etc/security/limits.conf, to a user.");
}

}  // namespace

std::string becomeRealTime(const RealTimeOptions& options) {
  std::string refused;
  if (options.lock_memory) refused += lockMemory();
  if (options.core >= 0) refused += runOn(options.core);
  if (options.priority > 0) refused += takePriority(options.priority);
  return refused;
}

bool answersInPublisher(const std::string& answer, const RealTimeOptions& options) {
  if (answer == "publisher") return true;
  if (answer == "thread") return false;
  if (answer == "auto") return options.priority <= 0 && options.core < 0;
  throw polyfly::Error("real_time/answer: must be one of auto, publisher, thread, got '" + answer + "'");
}

}  // namespace polyfly_ros
