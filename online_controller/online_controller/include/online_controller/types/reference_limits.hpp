#pragma once

#include "polyfly_base/range.hpp"

namespace polyfly {

/// Within what a reference is believed. What asks for more is a slip of a digit, of a unit or of a frame.
struct ReferenceLimits {
  /// Greatest distance of any point from the vehicle when the reference comes [m].
  double distance = 1000.0;
  /// Greatest speed of a trajectory, at its points and midway between them [m/s].
  double speed = 30.0;
};

/// The one list of these options, as visitOptions of MultirotorOptions.
template <class Options, class Visit>
void visitReferenceLimits(Options& options, Visit&& visit) {
  visit("reference_limits/distance", options.distance, "m", Range{0.1, 1e7});
  visit("reference_limits/speed", options.speed, "m/s", Range{0.1, 1e7});
}

}  // namespace polyfly
