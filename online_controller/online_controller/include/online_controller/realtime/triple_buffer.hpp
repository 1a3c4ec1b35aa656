#pragma once

#include <array>
#include <atomic>

namespace polyfly {

/// Passes the latest value of one writing thread to one reading thread. Neither waits for the other, and a value is
/// never seen half written. The writer fills one buffer, the reader looks at another, and the third one lies between
/// them.
template <class T>
class TripleBuffer {
 public:
  /// All three buffers are copies of `value`, so that they may hold memory of their own.
  explicit TripleBuffer(const T& value) : buffers_{value, value, value} {}

  /// Writer: the buffer to fill; it holds an older value.
  T& draft() noexcept { return buffers_[written_]; }

  /// Writer: the draft is the latest value from now on.
  void publish() noexcept {
    written_ = between_.exchange(written_ | kFresh, std::memory_order_acq_rel) & kIndex;
  }

  /// Reader: the latest value, unchanged until the next call. nullptr before the first.
  const T* read() noexcept {
    if ((between_.load(std::memory_order_relaxed) & kFresh) != 0) {
      read_ = between_.exchange(read_, std::memory_order_acq_rel) & kIndex;
      has_value_ = true;
    }
    return has_value_ ? &buffers_[read_] : nullptr;
  }

 private:
  static constexpr unsigned kIndex = 3;
  static constexpr unsigned kFresh = 4;

  std::array<T, 3> buffers_;
  // Buffer of the writer.
  unsigned written_ = 0;
  // Buffer of the reader.
  unsigned read_ = 1;
  bool has_value_ = false;
  std::atomic<unsigned> between_{2};
};

}  // namespace polyfly
