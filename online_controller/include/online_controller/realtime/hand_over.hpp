#pragma once

#include <atomic>
#include <memory>

namespace polyfly {

/// Passes objects to the control thread without a lock, and takes back those they replace, so that nothing
/// is built or freed there. One thread offers and collects, one takes. What is neither taken nor collected
/// is freed with this.
template <class T>
class HandOver {
 public:
  HandOver() = default;
  HandOver(const HandOver&) = delete;
  HandOver& operator=(const HandOver&) = delete;
  ~HandOver() {
    delete offered_.load();
    delete returned_.load();
  }

  /// Offers `next` in place of what was offered before and not taken, which is freed.
  void offer(std::unique_ptr<T> next) {
    collect();
    delete offered_.exchange(next.release(), std::memory_order_acq_rel);
  }

  /// Whether an offer waits to be taken.
  bool waits() const noexcept { return offered_.load(std::memory_order_acquire) != nullptr; }

  /// Frees what the control thread gave back.
  void collect() { delete returned_.exchange(nullptr, std::memory_order_acq_rel); }

  /// Control thread: replaces `current` by what is offered, after adopt(next, *current). False, and nothing
  /// is done, without an offer or as long as the last one's predecessor was not collected.
  template <class Adopt>
  bool take(std::unique_ptr<T>& current, Adopt&& adopt) noexcept {
    if (!waits() || returned_.load(std::memory_order_acquire) != nullptr) return false;
    T* next = offered_.exchange(nullptr, std::memory_order_acq_rel);
    adopt(*next, static_cast<const T&>(*current));
    returned_.store(current.release(), std::memory_order_release);
    current.reset(next);  // it is empty: nothing is freed
    return true;
  }

 private:
  std::atomic<T*> offered_{nullptr};   // owned
  std::atomic<T*> returned_{nullptr};  // owned; only the control thread fills it, only the other empties it
};

}  // namespace polyfly
