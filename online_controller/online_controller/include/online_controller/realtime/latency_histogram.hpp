#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace polyfly {

/// Counts durations in bins of equal ratio, at most 1/16 wide. One thread records, without a lock; another
/// reads percentiles at any time.
class LatencyHistogram {
 public:
  void record(std::int64_t nanoseconds) noexcept;

  /// The duration that `share` (0 to 1) of those recorded do not exceed. It is the upper end of its bin, so never too
  /// small, and at most 1/16 too great. 0 when there is none [ns].
  std::int64_t percentile(double share) const noexcept;

  std::int64_t count() const noexcept;
  std::int64_t greatest() const noexcept { return greatest_.load(std::memory_order_relaxed); }  ///< [ns]

  /// Starts anew. What is recorded meanwhile may or may not count.
  void clear() noexcept;

 private:
  // There are 16 bins in each octave.
  static constexpr int kStepBits = 4;
  // The last bin counts all durations above 2^40 ns.
  static constexpr int kBins = (40 - kStepBits + 1) << kStepBits;

  static int binOf(std::int64_t nanoseconds) noexcept;
  static std::int64_t upperEnd(int bin) noexcept;

  std::array<std::atomic<std::uint32_t>, kBins> bins_{};
  std::atomic<std::int64_t> greatest_{0};
};

}  // namespace polyfly
