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
  double duration = 30.0;  ///< [s]
  /// Rate of the response, with jittered times [Hz].
  double response_rate = 50.0;
  double command_rate = 50.0;  ///< [Hz]
};

/// A flight of concatenated 2-1-1 manoeuvres of several amplitudes and both signs. Integrated by Runge-Kutta
/// in small steps, so it shares nothing with the response of the library.
LoopRecord makeFlight(const MadeLoop& loop, std::uint32_t seed);

}  // namespace polyfly::test
