#pragma once

#include <cstdint>
#include <vector>

#include "identification/flight_signals.hpp"

namespace polyfly::test {

/// What a made flight has beside its manoeuvres.
struct MadeStretches {
  /// The vehicle stands before take-off and after landing, for so long each, with its throttle at zero [s].
  double stands = 0.0;
  /// It tumbles at the end, at 12 rad/s, for so long [s].
  double tumbles = 0.0;
  /// Amid the manoeuvres another mode flies it for so long: the response follows something else than the logged
  /// command [s].
  double other_mode = 0.0;
  /// Amid the manoeuvres the logged command is stuck for so long while the true one goes on [s].
  double stuck = 0.0;
  /// It hovers for so long before the manoeuvres, with small corrections [s].
  double hovers = 0.0;
  /// Manoeuvres, in two halves of equal length [s].
  double manoeuvres = 60.0;
  /// False: throttle and accelerometer are not recorded.
  bool many_signs = true;
};

struct MadeStretchesFlight {
  FlightSignals signals;
  /// The manoeuvres that are flown as commanded, as one would choose them by hand.
  std::vector<TimeWindow> by_hand;
  /// The whole time in the air, without the tumble.
  TimeWindow in_air;
};

/// A multirotor of 1.5 kg with lag and delay in roll, pitch and yaw rate, drag, gusts and noisy sensors, integrated in
/// small steps. Order: stands, takes off, hovers, first half of the manoeuvres, other mode, stuck command, second half,
/// lands and stands, or tumbles.
MadeStretchesFlight makeStretches(const MadeStretches& made, std::uint32_t seed);

}  // namespace polyfly::test
