#pragma once

#include <vector>

#include "identification/loop_record.hpp"

namespace polyfly {

enum class LoopOrder {
  kFirst,   ///< y' = (K u(t - delay) - y) / tau, Eq. 37
  kSecond,  ///< y'' = b0 u(t - delay) - a1 y' - a0 y, Eq. 45; a0 = omega^2, a1 = 2 zeta omega, b0 = K a0
};

/// What makes the shape of a loop's response; its gain only scales it.
struct LoopShape {
  LoopOrder order = LoopOrder::kFirst;
  double tau = 0.2;    ///< time constant, first order only [s], > 0
  double omega = 5.0;  ///< natural frequency, second order only [rad/s], > 0
  double zeta = 0.8;   ///< damping ratio, second order only, > 0
  double delay = 0.0;  ///< [s]; negative where the response comes before the command
};

/// The response of the model over one segment is gain * forced + sum of initial states * free + offset.
struct LoopBasis {
  /// Response for unit gain, from rest.
  std::vector<double> forced;
  /// Response of each initial state: the value, and for second order the rate.
  std::vector<std::vector<double>> free;
};

/// Exact for a command that holds its values: no step of integration is involved, and the delay is
/// continuous.
LoopBasis loopBasis(const LoopShape& shape, const LoopSegment& segment);

}  // namespace polyfly
