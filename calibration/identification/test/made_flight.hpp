#pragma once

#include <cstdint>
#include <vector>

#include "identification/loop_record.hpp"
#include "identification/loop_response.hpp"

namespace polyfly::test {

/// What a made flight hides from the identification.
struct MadeLoop {
  LoopOrder order = LoopOrder::kFirst;
  double gain = 1.0;
  /// Time constant, first order [s].
  double tau = 0.2;
  /// Coefficient a0 of Eq. 45, second order [1/s^2].
  double a0 = 14.0;
  /// Coefficient a1 of Eq. 45, second order [1/s].
  double a1 = 6.5;
  double delay = 0.1;  ///< [s]
  double offset = 0.01;
  /// Standard deviation of the white noise.
  double noise = 0.004;
  /// Standard deviation of a disturbance with a correlation time of 0.3 s.
  double coloured_noise = 0.0;
  /// Quantum of the logged command. The loop gets the exact command.
  double quantum = 0.0;
  /// Standard deviation of gain, lag and delay over the flight, relative to their values. They drift slowly.
  double drift = 0.0;
  /// Correlation time of this drift [s].
  double drift_memory = 20.0;
  double duration = 30.0;  ///< [s]
  /// Shortest pulse of a manoeuvre [s].
  double pulse = 0.6;
  /// Factor of the command's amplitudes.
  double size = 1.0;
  /// Rate of the response, with jittered times [Hz].
  double response_rate = 50.0;
  double command_rate = 50.0;  ///< [Hz]
};

/// A flight of concatenated 2-1-1 manoeuvres of several amplitudes and both signs. Integrated by Runge-Kutta
/// in small steps, so it shares nothing with the response of the library.
LoopRecord makeFlight(const MadeLoop& loop, std::uint32_t seed);

/// Several flights of one vehicle whose gain, lag and delay differ from flight to flight by `spread` (standard
/// deviation, relative to those of `vehicle`).
std::vector<LoopRecord> makeFlights(const MadeLoop& vehicle, double spread, int count, std::uint32_t seed);

}  // namespace polyfly::test
