#include "online_controller/realtime/latency_histogram.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {

// Below 16 ns each bin is one nanosecond; above, the four bits after the leading one number the bin.
int LatencyHistogram::binOf(std::int64_t nanoseconds) noexcept {
  if (nanoseconds < (1 << kStepBits)) return static_cast<int>(std::max<std::int64_t>(nanoseconds, 0));
  const auto value = static_cast<std::uint64_t>(nanoseconds);
  int octave = 0;
  while ((value >> (octave + kStepBits + 1)) != 0) ++octave;
  const int step = static_cast<int>(value >> octave) - (1 << kStepBits);
  return std::min(((octave + 1) << kStepBits) + step, kBins - 1);
}

std::int64_t LatencyHistogram::upperEnd(int bin) noexcept {
  if (bin < (1 << kStepBits)) return bin;
  const int octave = (bin >> kStepBits) - 1;
  const std::int64_t step = (bin & ((1 << kStepBits) - 1)) + (1 << kStepBits);
  return ((step + 1) << octave) - 1;
}

void LatencyHistogram::record(std::int64_t nanoseconds) noexcept {
  bins_[static_cast<std::size_t>(binOf(nanoseconds))].fetch_add(1, std::memory_order_relaxed);
  if (nanoseconds > greatest()) greatest_.store(nanoseconds, std::memory_order_relaxed);
}

std::int64_t LatencyHistogram::count() const noexcept {
  std::int64_t sum = 0;
  for (const auto& bin : bins_) sum += bin.load(std::memory_order_relaxed);
  return sum;
}

std::int64_t LatencyHistogram::percentile(double share) const noexcept {
  const std::int64_t all = count();
  if (all == 0) return 0;
  const auto wanted = std::max<std::int64_t>(
      1, static_cast<std::int64_t>(std::ceil(std::clamp(share, 0.0, 1.0) * static_cast<double>(all))));
  std::int64_t sum = 0;
  for (int bin = 0; bin < kBins - 1; ++bin) {
    sum += bins_[static_cast<std::size_t>(bin)].load(std::memory_order_relaxed);
    if (sum >= wanted) return std::min(upperEnd(bin), greatest());
  }
  return greatest();
}

void LatencyHistogram::clear() noexcept {
  for (auto& bin : bins_) bin.store(0, std::memory_order_relaxed);
  greatest_.store(0, std::memory_order_relaxed);
}

}  // namespace polyfly
