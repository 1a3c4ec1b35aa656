#pragma once

#include <chrono>
#include <cstdint>

namespace polyfly_ros {

/// Times the stages of a control period, from its construction on.
class StageClock {
 public:
  /// Since the last call [ns].
  std::int64_t lap() noexcept {
    const Clock::time_point now = Clock::now();
    const auto spent = std::chrono::duration_cast<std::chrono::nanoseconds>(now - last_).count();
    last_ = now;
    return spent;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

}  // namespace polyfly_ros
