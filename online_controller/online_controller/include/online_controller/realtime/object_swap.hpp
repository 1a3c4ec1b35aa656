#pragma once

#include <atomic>
#include <memory>

namespace polyfly {

/// Passes objects to the control thread without a lock, and takes back those that they replace. Nothing is
/// built or freed in the control thread. One thread stages and reclaims, one thread swaps. What is neither
/// swapped in nor reclaimed is freed with this.
template <class T>
class ObjectSwap {
 public:
  ObjectSwap() = default;
  ObjectSwap(const ObjectSwap&) = delete;
  ObjectSwap& operator=(const ObjectSwap&) = delete;
  ~ObjectSwap() {
    delete staged_.load();
    delete replaced_.load();
  }

  /// Stages `next`. An object that was staged before and not swapped in is freed.
  void stage(std::unique_ptr<T> next) {
    reclaim();
    delete staged_.exchange(next.release(), std::memory_order_acq_rel);
  }

  /// Whether an object is staged and not swapped in yet.
  bool pending() const noexcept { return staged_.load(std::memory_order_acquire) != nullptr; }

  /// Frees the object that was replaced.
  void reclaim() { delete replaced_.exchange(nullptr, std::memory_order_acq_rel); }

  /// Control thread: calls transfer(next, *current) and replaces `current` by the staged object. False, and
  /// nothing is done, where none is staged or the object replaced last has not been reclaimed.
  template <class Transfer>
  bool swap(std::unique_ptr<T>& current, Transfer&& transfer) noexcept {
    if (!pending() || replaced_.load(std::memory_order_acquire) != nullptr) return false;
    T* next = staged_.exchange(nullptr, std::memory_order_acq_rel);
    transfer(*next, static_cast<const T&>(*current));
    replaced_.store(current.release(), std::memory_order_release);
    current.reset(next);  // it is empty: nothing is freed
    return true;
  }

 private:
  std::atomic<T*> staged_{nullptr};    // owned
  std::atomic<T*> replaced_{nullptr};  // owned; only the control thread fills it, only the other empties it
};

}  // namespace polyfly
