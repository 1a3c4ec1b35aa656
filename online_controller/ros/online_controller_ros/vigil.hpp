#pragma once

#include <semaphore.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace polyfly_ros {

/// Keeps a processor from going to sleep for a moment, and its caches from being lost meanwhile: a thread
/// that the operating system runs only where nothing else wants to (SCHED_IDLE) waits there without sleeping.
class Vigil {
 public:
  using Clock = std::chrono::steady_clock;

  Vigil();
  Vigil(const Vigil&) = delete;
  Vigil& operator=(const Vigil&) = delete;
  ~Vigil();

  /// On that processor, until then or until end(). Takes no lock.
  void keep(int core, Clock::time_point until) noexcept;
  void end() noexcept { until_.store(Clock::time_point::min(), std::memory_order_relaxed); }

 private:
  void watch() noexcept;

  sem_t begun_;
  std::atomic<Clock::time_point> until_{Clock::time_point::min()};
  std::atomic<int> core_{-1};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace polyfly_ros
