#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "mpc_core/coefficient_estimate.hpp"
#include "mpc_core/observer.hpp"
#include "nonlinear_mpc/multirotor_model.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// Standard deviation of the drag over mass that a model leaves out [1/s].
constexpr double kDragDeviation = 0.2;

/// Kalman filter for position, velocity and external force of Eq. 37. The specific force of the rotors follows from
/// the measured attitude and the thrust that was sent. So the rest of the model is linear, and its steady-state gain
/// is exact at any tilt:
///
///     p' = v,  v' = R e_z T - g e_z - R A R' v + d,  d' = 0, or d' = r and r' = -r / 1 s.
///
/// The drag that A leaves out can be found too. The force is then d - c v, with a c [1/s] each along x and y of W.
class ForceObserver {
 public:
  static constexpr int kMaxPeriods = DisturbanceObserver::kMaxPeriods;

  /// Period, noise and drift of d are those of the options. `rate_drift` is that of the rate r per control period; 0: d
  /// has none [m/s^3]. With `finds_drag` c is found, otherwise 0. Throws Error when one is out of range.
  ForceObserver(const MultirotorModel& model, const MultirotorOptions& options, double rate_drift = 0.0,
                bool finds_drag = false);

  /// The sample came `periods` periods after the last one; `thrust` over mass [m/s^2] was held meanwhile. The
  /// first sample after reset, or one more than kMaxPeriods late, sets the state and keeps d. c is learnt from the
  /// `followed` velocity, that of the reference; without one it is forgotten [m/s].
  void update(const VehicleState& state, double thrust, int periods,
              const std::optional<Eigen::Vector3d>& followed = Eigen::Vector3d::Zero().eval()) noexcept;

  void reset() noexcept;
  /// Sets the estimate of d [m/s^2], its rate and c to 0.
  void setDisturbance(const Eigen::Vector3d& disturbance) noexcept;
  /// Continues with the estimates of `other`. An observer that finds no c takes what c makes of the velocity into d.
  void transferState(const ForceObserver& other) noexcept;

  Eigen::Vector3d position() const noexcept;  ///< [m]
  Eigen::Vector3d velocity() const noexcept;  ///< [m/s]
  /// External force over mass, d [m/s^2].
  Eigen::Vector3d disturbance() const noexcept;
  /// Rate r of d [m/s^3].
  Eigen::Vector3d disturbanceRate() const noexcept;
  /// c along the axes of W [1/s].
  Eigen::Vector3d drag() const noexcept;

 private:
  Eigen::Vector3d acceleration(const Eigen::Matrix3d& R, const Eigen::Vector3d& velocity,
                               double thrust) const noexcept;

  MultirotorModel model_;
  std::array<DisturbanceObserver, 3> axes_;
  // Of x and y.
  std::optional<std::array<CoefficientEstimate, 2>> drag_;
  Eigen::Matrix3d last_attitude_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d last_velocity_ = Eigen::Vector3d::Zero();
  bool started_ = false;
};

}  // namespace polyfly
