#pragma once

#include <Eigen/Core>
#include <array>

#include "mpc_core/observer.hpp"
#include "nonlinear_mpc/multirotor_model.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// Kalman filter for position, velocity and external force of Eq. 37. The specific force of the rotors
/// follows from the attitude, which is measured, and the thrust that was sent, so the rest of the model is
/// linear and its steady-state gain is exact at any tilt:
///
///     p' = v,  v' = R e_z T - g e_z - R A R' v + d,  d' = 0, or d' = r and r' = -r / 1 s.
class ForceObserver {
 public:
  static constexpr int kMaxPeriods = DisturbanceObserver::kMaxPeriods;

  /// Period, noise and drift of d are those of the options. `rate_drift` is that of the rate r per control period; 0: d
  /// has none [m/s^3]. Throws Error when one is out of range.
  ForceObserver(const MultirotorModel& model, const MultirotorOptions& options, double rate_drift = 0.0);

  /// The sample came `periods` periods after the last one; `thrust` over mass [m/s^2] was held meanwhile. The
  /// first sample after reset, or one more than kMaxPeriods late, sets the state and keeps d.
  void update(const VehicleState& state, double thrust, int periods) noexcept;

  void reset() noexcept;
  /// Sets the estimate of d [m/s^2], and its rate to 0.
  void setDisturbance(const Eigen::Vector3d& disturbance) noexcept;
  /// Continues with the estimates of `other`.
  void transferState(const ForceObserver& other) noexcept;

  Eigen::Vector3d position() const noexcept;  ///< [m]
  Eigen::Vector3d velocity() const noexcept;  ///< [m/s]
  /// External force over mass, d [m/s^2].
  Eigen::Vector3d disturbance() const noexcept;
  /// Rate r of d [m/s^3].
  Eigen::Vector3d disturbanceRate() const noexcept;

 private:
  Eigen::Vector3d acceleration(const Eigen::Matrix3d& R, const Eigen::Vector3d& velocity,
                               double thrust) const noexcept;

  MultirotorModel model_;
  std::array<DisturbanceObserver, 3> axes_;
  Eigen::Matrix3d last_attitude_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d last_velocity_ = Eigen::Vector3d::Zero();
  bool started_ = false;
};

}  // namespace polyfly
