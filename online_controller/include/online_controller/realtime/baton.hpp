#pragma once

#include <atomic>
#include <chrono>
#include <thread>

namespace polyfly {

/// Whoever holds it may use what it guards. A thread that must not wait tries to take it, in one atomic
/// exchange; a thread that may wait does so without keeping a processor from the holder, whatever the
/// priorities of the two. What was done with the baton is seen by the next holder. A holder that tries again
/// gets nothing.
class Baton {
 public:
  /// In the hands of whoever makes it.
  Baton() = default;
  Baton(const Baton&) = delete;
  Baton& operator=(const Baton&) = delete;

  /// Never waits. Whether it was free.
  bool tryTake() noexcept {
    return free_.load(std::memory_order_relaxed) && free_.exchange(false, std::memory_order_acquire);
  }

  /// Waits until it is free.
  void take() noexcept {
    for (int tries = 0; !tryTake(); ++tries) {
      if (tries < kHopefulTries) {
        std::this_thread::yield();
      } else {
        std::this_thread::sleep_for(kPatience);  // a holder of less priority gets the processor
      }
    }
  }

  void give() noexcept { free_.store(true, std::memory_order_release); }

 private:
  static constexpr int kHopefulTries = 8;
  static constexpr std::chrono::microseconds kPatience{20};

  std::atomic<bool> free_{false};
};

/// Holds a baton for as long as it lives; nullptr: nothing to hold.
class BatonHold {
 public:
  /// Waits for it.
  explicit BatonHold(Baton* baton) noexcept : baton_(baton) {
    if (baton_ != nullptr) baton_->take();
  }
  BatonHold(const BatonHold&) = delete;
  BatonHold& operator=(const BatonHold&) = delete;
  ~BatonHold() {
    if (baton_ != nullptr) baton_->give();
  }

 private:
  Baton* baton_;  // not owned
};

}  // namespace polyfly
