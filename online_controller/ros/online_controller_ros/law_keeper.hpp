#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "online_controller/realtime/hand_over.hpp"
#include "online_controller_ros/law_setup.hpp"

namespace polyfly_ros {

/// The laws that fly, and those that shall fly next. The control thread flies and exchanges; one other thread
/// builds and frees. Neither waits for the other.
class LawKeeper {
 public:
  /// Throws Error naming file, signal and rule.
  explicit LawKeeper(const LawSetup& setup) : laws_(std::make_unique<Laws>(setup)) {}

  // The control thread's.
  Laws& laws() noexcept { return *laws_; }
  polyfly::LawSwitch& flight() noexcept { return laws_->flight(); }

  /// Takes the laws that were offered, which go on where the present ones are. For the time after a step and
  /// before prepare(). Never allocates, frees, locks or throws. Whether there were any.
  bool exchange() noexcept {
    const bool taken =
        next_.take(laws_, [](Laws& next, const Laws& old) noexcept { next.flight().takeOver(old.flight()); });
    if (taken) exchanges_.fetch_add(1, std::memory_order_relaxed);
    return taken;
  }

  // The other thread's.
  /// Builds laws and offers them. Throws Error, and nothing changes, when they cannot be built.
  void offer(const LawSetup& setup) { next_.offer(std::make_unique<Laws>(setup)); }
  void collect() { next_.collect(); }                    ///< frees the laws that were replaced
  bool waits() const noexcept { return next_.waits(); }  ///< an offer has not been taken yet
  std::int64_t exchanges() const noexcept { return exchanges_.load(std::memory_order_relaxed); }

 private:
  std::unique_ptr<Laws> laws_;
  polyfly::HandOver<Laws> next_;
  std::atomic<std::int64_t> exchanges_{0};
};

}  // namespace polyfly_ros
