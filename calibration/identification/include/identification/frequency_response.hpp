#pragma once

#include <vector>

#include "identification/fit_loop.hpp"
#include "identification/loop_record.hpp"

namespace polyfly {

/// Response over command at one frequency.
struct FrequencyPoint {
  double frequency = 0.0;  ///< [Hz]
  double gain = 0.0;
  /// Phase, unwrapped from the lowest frequency on [rad].
  double phase = 0.0;
  /// Coherence, 0..1. It is the share of the response that is linear in the command.
  double coherence = 0.0;
  /// Power of the command, relative to its greatest value.
  double command_power = 0.0;
};

/// Averaged over overlapping Hann windows of `block` seconds in all segments (Welch). The `points` frequencies are
/// evenly spaced on a logarithmic scale from two periods in a block to `greatest` [Hz]. Empty if no segment holds two
/// blocks' worth of data. A mean that the response was smoothed by is part of what is measured.
std::vector<FrequencyPoint> measureFrequencyResponse(const std::vector<LoopSegment>& segments, double block,
                                                     double greatest, int points);

/// The model's gain and phase at a frequency [Hz].
FrequencyPoint modelFrequencyResponse(const LoopFit& fit, double frequency);

}  // namespace polyfly
