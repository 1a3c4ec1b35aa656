#pragma once

#include "fixedwing_lateral/model.hpp"
#include "fixedwing_lateral/path.hpp"

namespace polyfly {

/// The direction of the turn for a course error of nearly half a turn. kNone: as the error is wrapped (Eq. 49). Else
/// errors of up to 240 degrees to one side stay on that side, and e_t does not count.
///
/// With kNone alone, noise would select the side anew in each call and at each node. From 20 m/s on, flying in the wrong
/// direction beside the path is a local optimum: a turn costs more in e_t, which grows to two radii, than it gains in
/// e_chi.
enum class Reversal : std::int8_t { kLeft = -1, kNone = 0, kRight = 1 };

constexpr double kReversalShift = kPi / 3.0;  ///< of the course error's range [rad]

/// The error of Eq. 49 [rad], in [-pi, pi) moved by the shift to that side.
inline double courseError(double wrapped, Reversal reversal) noexcept {
  if (reversal == Reversal::kNone) return wrapped;
  const double shift = reversal == Reversal::kRight ? kReversalShift : -kReversalShift;
  return wrapCourse(wrapped - shift) + shift;
}

/// What a horizon flies along and in: at most two segments.
struct HorizonData {
  LateralConditions conditions;  ///< its gate is at the end of `current`
  PathSegment current;
  PathSegment next;                          ///< past the gate; `current` once more where nothing follows
  Reversal reversal = Reversal::kNone;       ///< along `current`
  Reversal next_reversal = Reversal::kNone;  ///< along `next`
};

}  // namespace polyfly
