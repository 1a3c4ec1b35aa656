#pragma once

#include "fixedwing_lateral/model.hpp"
#include "fixedwing_lateral/path.hpp"

namespace polyfly {

/// The direction of the turn for a course error of nearly half a turn. kNone: as the error is wrapped (Eq. 49). Else
/// errors of up to 240 degrees to one side stay on that side, and e_t does not count.
///
/// With kNone alone, noise would select the side anew in each call and at each node. From 20 m/s on, flying in the
/// wrong direction beside the path is a local optimum. A turn costs more in e_t, which grows to two radii, than it
/// gains in e_chi.
enum class Reversal : std::int8_t { kLeft = -1, kNone = 0, kRight = 1 };

/// Shift of the course error's range [rad].
constexpr double kReversalShift = kPi / 3.0;

/// The error of Eq. 49 [rad], in [-pi, pi) moved by the shift to that side.
inline double courseError(double wrapped, Reversal reversal) noexcept {
  if (reversal == Reversal::kNone) return wrapped;
  const double shift = reversal == Reversal::kRight ? kReversalShift : -kReversalShift;
  return wrapCourse(wrapped - shift) + shift;
}

/// What a horizon flies along and in: at most two segments.
struct HorizonData {
  /// Conditions of the horizon, with the switch gate at the end of `current`.
  LateralConditions conditions;
  PathSegment current;
  /// Segment after the gate; equal to `current` where nothing follows.
  PathSegment next;
  /// Direction of the turn on `current`.
  Reversal reversal = Reversal::kNone;
  /// Direction of the turn on `next`.
  Reversal next_reversal = Reversal::kNone;
};

}  // namespace polyfly
