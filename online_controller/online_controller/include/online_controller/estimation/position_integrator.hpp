#pragma once

#include <Eigen/Core>

#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// The integral of the position error, as a disturbance that the targets answer: for what the observer's
/// model explains wrongly. Optional; offset-free tracking does not need it.
///
/// Against wind-up an axis integrates only while its error lies within antiwindup_ball. The last command must also be
/// the law's own and within all limits. The integral of the error is bounded by integral_limit.
class PositionIntegrator {
 public:
  explicit PositionIntegrator(const MultirotorOptions& options) noexcept : options_(options) {}

  /// The error at a sample, before its step. `last` is the command of the step before; the first sample after
  /// a reset integrates nothing.
  void update(const VehicleState& state, const Reference& reference, const ControlReport& last) noexcept;

  void reset() noexcept;
  void transferState(const PositionIntegrator& other) noexcept;

  /// Disturbance for the targets; 0 where the integrator is not enabled [m/s^2].
  Eigen::Vector3d disturbance() const noexcept;

 private:
  MultirotorOptions options_;
  // Integral of the position error [m s].
  Eigen::Vector3d integral_ = Eigen::Vector3d::Zero();
  double last_stamp_ = 0.0;
  bool started_ = false;
};

}  // namespace polyfly
