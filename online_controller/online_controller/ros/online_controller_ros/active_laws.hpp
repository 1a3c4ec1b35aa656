#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "online_controller/realtime/object_swap.hpp"
#include "online_controller_ros/law_setup.hpp"

namespace polyfly_ros {

/// The laws that fly, and those that are staged to replace them. The control thread flies and swaps. One other
/// thread stages and reclaims. Neither waits for the other.
class ActiveLaws {
 public:
  /// Throws Error naming file, signal and rule.
  explicit ActiveLaws(const LawSetup& setup)
      : laws_(std::make_unique<Laws>(setup)), active_(laws_->flight().active()) {}

  // The control thread's.
  Laws& laws() noexcept { return *laws_; }
  polyfly::LawSwitch& flight() noexcept { return laws_->flight(); }

  /// Replaces the laws by the staged ones, which go on from the same state. To be called after a step and
  /// before prepare(). Never allocates, frees, locks or throws. Whether laws were staged.
  bool swap() noexcept {
    const bool swapped = next_.swap(
        laws_, [](Laws& next, const Laws& old) noexcept { next.flight().transferState(old.flight()); });
    if (swapped) swaps_.fetch_add(1, std::memory_order_relaxed);
    return swapped;
  }

  /// From the next step on. False, and nothing changes, when there is no such law.
  bool select(polyfly::Law law) noexcept {
    const bool selected = laws_->flight().select(law);
    active_.store(laws_->flight().active(), std::memory_order_relaxed);
    return selected;
  }

  // Any thread's.
  polyfly::Law active() const noexcept { return active_.load(std::memory_order_relaxed); }

  // The other thread's.
  /// Builds laws and stages them. Throws Error, and nothing changes, when they cannot be built.
  void stage(const LawSetup& setup) { next_.stage(std::make_unique<Laws>(setup)); }
  void reclaim() { next_.reclaim(); }                        ///< frees the laws that were replaced
  bool pending() const noexcept { return next_.pending(); }  ///< laws are staged and not swapped in yet
  std::int64_t swaps() const noexcept { return swaps_.load(std::memory_order_relaxed); }

 private:
  std::unique_ptr<Laws> laws_;
  polyfly::ObjectSwap<Laws> next_;
  std::atomic<std::int64_t> swaps_{0};
  std::atomic<polyfly::Law> active_;
};

}  // namespace polyfly_ros
