#pragma once

#include <cmath>

namespace polyfly {

/// When a law that decides less often than odometry comes is due again. Its decisions lie on a time line of
/// their own, a period apart, so that jitter of the stamps does not add up.
class SamplingClock {
 public:
  SamplingClock() = default;  ///< due at each sample

  /// A decision every `period` [s], which holds a whole number of samples `sample` [s] apart.
  SamplingClock(double period, double sample) : period_(period), play_(0.5 * sample) {}

  double period() const noexcept { return period_; }  ///< 0: each sample [s]

  /// Whether the law decides at time `stamp` [s]: at first, a period after the last decision, and where time
  /// went back.
  bool due(double stamp) const noexcept {
    return !running_ || stamp >= next_ - play_ || stamp < next_ - period_ - play_;
  }

  /// It has decided at `stamp`.
  void decided(double stamp) noexcept {
    next_ = (running_ && std::abs(stamp - next_) <= play_ ? next_ : stamp) + period_;
    running_ = period_ > 0.0;
  }

  void reset() noexcept { running_ = false; }  ///< due at the next sample

 private:
  double period_ = 0.0;
  double play_ = 0.0;
  double next_ = 0.0;  // [s]
  bool running_ = false;
};

}  // namespace polyfly
