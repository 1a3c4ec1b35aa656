#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "identification/loop_record.hpp"
#include "identification/loop_response.hpp"

namespace polyfly {

/// Where to look for a loop's parameters, and how hard.
struct FitOptions {
  LoopOrder order = LoopOrder::kFirst;
  bool with_delay = true;
  /// Least delay [s]. It is negative only to find out whether clocks disagree.
  double delay_least = 0.0;
  double delay_greatest = 0.6;   ///< [s]
  double tau_least = 0.004;      ///< [s]
  double tau_greatest = 3.0;     ///< [s]
  double omega_least = 0.5;      ///< [rad/s]
  double omega_greatest = 80.0;  ///< [rad/s]
  double zeta_least = 0.1;
  double zeta_greatest = 4.0;
  /// Evaluations of the search over the whole box for two unknowns. Three unknowns get twice as many.
  int global_evaluations = 350;
  /// Evaluations of each local search.
  int local_evaluations = 250;
};

/// A number from the data with what they say about its error.
struct FittedParameter {
  std::string name;
  std::string unit;
  double value = 0.0;
  /// Half width of the 95 % confidence interval. It is NaN where the data do not bound the value.
  double half_width = 0.0;
  /// Whether the data are sufficient to use the value.
  bool supported = true;
  /// Lower end of the 95 % confidence interval.
  double least() const { return value - half_width; }
  /// Upper end of the 95 % confidence interval.
  double greatest() const { return value + half_width; }
};

/// A model with the segments that it was fitted to.
struct LoopFit {
  LoopShape shape;
  double gain = 0.0;
  /// Offset of the response (trim), in its unit.
  double offset = 0.0;
  /// First order: gain, tau, delay; second: a0, a1, b0, delay; offset.
  std::vector<FittedParameter> parameters;
  /// Covariance of tau and delay, as the squares of half widths [s^2]; 0 where the delay is not fitted.
  double lag_delay_square = 0.0;
  /// Fit 100 (1 - |y - model| / |y - mean y|) over all segments [%].
  double fit_percent = 0.0;
  /// Robust standard deviation of the residuals.
  double residual_scale = 0.0;
  std::size_t samples = 0;
  /// Predicted response of each segment, at its samples.
  std::vector<std::vector<double>> prediction;

  const FittedParameter* find(const std::string& name) const;
};

/// Fits gain, offset, shape and the initial state of each segment. It takes the least loss of Huber over the whole
/// box (DIRECT), then locally (Nelder-Mead) with the scale taken from the residuals. Gain, offset and initial states
/// are linear and solved for at every point. Intervals are those of an M-estimator whose residuals are
/// correlated in time (Newey and West 1987). Throws Error when there is no segment, or when command or response is
/// constant.
LoopFit fitLoop(const std::vector<LoopSegment>& segments, const FitOptions& options);

/// The same model on other segments: shape, gain and offset stay, initial states are fitted.
struct LoopPrediction {
  double fit_percent = 0.0;
  /// Predicted response of each segment.
  std::vector<std::vector<double>> prediction;
};
LoopPrediction predictLoop(const LoopFit& fit, const std::vector<LoopSegment>& segments);

}  // namespace polyfly
