#pragma once

#include "online_controller/types/types.hpp"

namespace polyfly {

/// The reference of a take-off or a landing: straight up to a height, or down until it is stopped.
class VerticalRamp {
 public:
  VerticalRamp() = default;

  /// From `start` at `time` [s] by `height` [m] within `duration` [s], on the quintic that starts and ends at
  /// rest; then it stays.
  static VerticalRamp up(const Reference& start, double time, double height, double duration) noexcept;

  /// From `start` down at `speed` [m/s], reached within the first second, for ever.
  static VerticalRamp down(const Reference& start, double time, double speed) noexcept;

  /// Time began anew, `seconds` later: the ramp goes on from where it was.
  void shift(double seconds) noexcept { time_ += seconds; }

  Reference at(double time) const noexcept;
  /// End of the way up [s].
  double end() const noexcept { return time_ + duration_; }

 private:
  Reference start_;
  double time_ = 0.0;
  double height_ = 0.0;
  double duration_ = 0.0;  // 0: down
  double speed_ = 0.0;
};

}  // namespace polyfly
