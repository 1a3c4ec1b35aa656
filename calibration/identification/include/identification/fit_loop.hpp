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
  double delay_least = 0.0;      ///< [s]; below zero only to tell whether clocks disagree
  double delay_greatest = 0.6;   ///< [s]
  double tau_least = 0.004;      ///< [s]
  double tau_greatest = 3.0;     ///< [s]
  double omega_least = 0.5;      ///< [rad/s]
  double omega_greatest = 80.0;  ///< [rad/s]
  double zeta_least = 0.1;
  double zeta_greatest = 4.0;
  int global_evaluations = 350;  ///< of the search over the whole box, for two unknowns; twice that for three
  int local_evaluations = 250;   ///< of each local search
};

/// A number from the data with what they say about its error.
struct FittedParameter {
  std::string name;
  std::string unit;
  double value = 0.0;
  double standard_error = 0.0;                            ///< NaN where the data do not bound it
  double half_width = 0.0;                                ///< of the 95 % interval
  bool supported = true;                                  ///< whether the data say enough to use it
  double least() const { return value - half_width; }     ///< of the 95 % interval
  double greatest() const { return value + half_width; }  ///< of the 95 % interval
};

/// A model with the segments that it was fitted to.
struct LoopFit {
  LoopShape shape;
  double gain = 0.0;
  double offset = 0.0;  ///< of the response (trim), in its unit
  /// First order: gain, tau, delay; second: a0, a1, b0, delay; offset.
  std::vector<FittedParameter> parameters;
  Eigen::MatrixXd correlation;  ///< of the parameters, in their order
  double fit_percent = 0.0;     ///< 100 (1 - |y - model| / |y - mean y|) over all segments
  double residual_rms = 0.0;    ///< in the response's unit
  double residual_scale = 0.0;  ///< robust standard deviation of the residuals
  double outlier_share = 0.0;   ///< of samples that the loss weighs down
  std::size_t samples = 0;
  std::vector<std::vector<double>> prediction;  ///< of each segment, at its samples

  const FittedParameter* find(const std::string& name) const;
};

/// Fits gain, offset, shape and the initial state of each segment: least loss of Huber over the whole box
/// (DIRECT), then locally (Nelder-Mead) with the scale taken from the residuals; gain, offset and initial
/// states are linear and solved for at every point. Standard errors are those of an M-estimator whose
/// residuals are correlated in time (Newey and West 1987). Throws Error when there is no segment, or when
/// command or response is constant.
LoopFit fitLoop(const std::vector<LoopSegment>& segments, const FitOptions& options);

/// The same model on other segments: shape, gain and offset stay, initial states are fitted.
struct LoopPrediction {
  double fit_percent = 0.0;
  double residual_rms = 0.0;
  std::vector<std::vector<double>> prediction;  ///< of each segment
};
LoopPrediction predictLoop(const LoopFit& fit, const std::vector<LoopSegment>& segments);

}  // namespace polyfly
