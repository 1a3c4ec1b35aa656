#pragma once

#include <Eigen/Core>
#include <array>

#include "online_controller/estimation/force_observer.hpp"
#include "online_controller/estimation/sample_line.hpp"
#include "online_controller/types/moment_model.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// What the observer makes of a vehicle, in W and in roll, pitch, yaw.
struct VehicleEstimate {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
  /// Roll, pitch and yaw; yaw is not wrapped [rad].
  Eigen::Vector3d attitude = Eigen::Vector3d::Zero();
  /// Rates of roll, pitch and yaw [rad/s].
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
  /// External force over mass, less the offset [m/s^2].
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  /// External moment over inertia, less the offset [rad/s^2].
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  /// Force offset found by calibration [m/s^2].
  Eigen::Vector3d force_offset = Eigen::Vector3d::Zero();
  /// Moment offset found by calibration [rad/s^2].
  Eigen::Vector3d moment_offset = Eigen::Vector3d::Zero();
};

/// Kalman filters for position, velocity, attitude, rates, external force and external moment: the force by
/// ForceObserver, the moments about each axis by the attitude's model. Whole periods between samples are counted from
/// the stamps. A gap or a stamp that goes back starts the state anew. A gap keeps the rest, such a stamp forgets it.
///
/// Calibration at hover takes the mean of force and moment for what is the model's fault: a wrong mass, a
/// thrust curve, a trim. After it they are subtracted.
///
/// update() never throws, allocates, locks, logs or reads a clock.
class VehicleObserver {
 public:
  /// `model` gives gravity and drag. Throws Error when an option is out of range.
  VehicleObserver(const MultirotorModel& model, const MultirotorOptions& vehicle, const MomentModel& moments);

  /// A valid sample, until which `held` was the command.
  void update(const VehicleState& state, const AttitudeCommand& held) noexcept;

  /// Goes on with what another one knows, a calibration under way included, by its own mass and noise.
  void transferState(const VehicleObserver& other) noexcept;

  /// The next sample sets the state anew; the estimates of force and moment are kept.
  void restart() noexcept;
  /// State as after construction, except for the offsets.
  void reset() noexcept;

  /// From the next sample on, for calibration_duration.
  void calibrate() noexcept;
  bool isCalibrating() const noexcept { return calibration_.runs; }
  /// Number of finished calibrations.
  unsigned calibrations() const noexcept { return calibration_.finished; }

  const VehicleEstimate& estimate() const noexcept { return estimate_; }

 private:
  void forget() noexcept;
  void updateMoments(const VehicleState& state, const AttitudeCommand& held, int periods) noexcept;
  void advanceCalibration(double stamp, const Eigen::Vector3d& force, const Eigen::Vector3d& moment) noexcept;

  double mass_;
  double duration_;
  ForceObserver force_;
  std::array<DisturbanceObserver, 3> angles_;
  VehicleEstimate estimate_;
  SampleLine line_;

  struct Calibration {
    bool runs = false;
    unsigned finished = 0;
    double start = 0.0;  // [s]
    int samples = 0;
    Eigen::Vector3d force_sum = Eigen::Vector3d::Zero();
    Eigen::Vector3d moment_sum = Eigen::Vector3d::Zero();
  };

  Calibration calibration_;
};

}  // namespace polyfly
