#pragma once

#include <atomic>
#include <chrono>
#include <thread>

namespace polyfly {

/// A mutex of one atomic flag, to be used with std::lock_guard and std::unique_lock. A thread that must not
/// wait tries to lock it, in one atomic exchange. A thread that may wait sleeps between its tries, so that an
/// owner of lower priority gets the processor. It is not recursive.
class TryLock {
 public:
  TryLock() = default;
  TryLock(const TryLock&) = delete;
  TryLock& operator=(const TryLock&) = delete;

  /// Never waits. Whether the caller is the owner now. The standard library demands this name.
  bool try_lock() noexcept {  // NOLINT(readability-identifier-naming)
    return !locked_.load(std::memory_order_relaxed) && !locked_.exchange(true, std::memory_order_acquire);
  }

  void lock() noexcept {
    for (int tries = 0; !try_lock(); ++tries) {
      if (tries < kYields) {
        std::this_thread::yield();
      } else {
        std::this_thread::sleep_for(kInterval);
      }
    }
  }

  void unlock() noexcept { locked_.store(false, std::memory_order_release); }

 private:
  static constexpr int kYields = 8;  // before it sleeps
  static constexpr std::chrono::microseconds kInterval{20};

  std::atomic<bool> locked_{false};
};

}  // namespace polyfly
