#pragma once

#include <cstdint>

#include "identification/loop_record.hpp"
#include "identification/loop_response.hpp"

namespace polyfly::test {

/// What a made flight hides from the identification.
struct MadeLoop {
  LoopOrder order = LoopOrder::kFirst;
  double gain = 1.0;
  double tau = 0.2;    ///< first order [s]
  double a0 = 14.0;    ///< second order [1/s^2]
  double a1 = 6.5;     ///< second order [1/s]
  double delay = 0.1;  ///< [s]
  double offset = 0.01;
  double noise = 0.004;         ///< standard deviation, white
  double coloured_noise = 0.0;  ///< standard deviation of a disturbance with a correlation time of 0.3 s
  double quantum = 0.0;         ///< of the logged command; the loop gets the exact one
  double duration = 30.0;       ///< [s]
  double response_rate = 50.0;  ///< [Hz], with jittered times
  double command_rate = 50.0;   ///< [Hz]
};

/// A flight of concatenated 2-1-1 manoeuvres of several amplitudes and both signs. Integrated by Runge-Kutta
/// in small steps, so it shares nothing with the response of the library.
LoopRecord makeFlight(const MadeLoop& loop, std::uint32_t seed);

}  // namespace polyfly::test
