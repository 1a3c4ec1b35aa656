#pragma once

#include <array>

#include "online_controller/laws/axis.hpp"
#include "online_controller/laws/estimating_law.hpp"
#include "online_controller/realtime/sampling_clock.hpp"
#include "online_controller/types/attitude.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

class RegionMap;

/// Linear MPC of a multirotor, a law for each axis (longitudinal, lateral, vertical): looked up in region
/// maps, or the same problems solved online (Eq. 38). Observer of Eq. 5, targets of Eq. 6 in the frame that
/// moves with the reference, world-to-body rotation of Eq. 40, compensation of Eq. 41. Used alike by the
/// nodelet and by the replay of a bag, so that both assemble the same parameters.
///
/// Each answer is a finite command within the limits. A parameter out of its range is answered as Axis::evaluate says.
/// There is no answer without a region, and with NaN or absurd numbers in odometry or reference.
///
/// Maps of a minimum-peak robust MPC promise peaks and bounds at their sampling time only. With them the laws are
/// evaluated that often. Their inputs are held in the world frame in between, where Eq. 40 and 41 are computed with
/// each sample. The report then holds the last evaluation.
///
/// The same calls after construction or reset give the same bits.
class MultirotorController : public EstimatingLaw {
 public:
  /// Maps in the order longitudinal, lateral, vertical; kept by reference. The model comes from the problem text in
  /// each map. Throws Error naming map, signal and rule when a map's signals are not those of its axis. Also when the
  /// sampling times of minimum-peak maps differ or are not whole control periods.
  MultirotorController(const std::array<const RegionMap*, 3>& maps, const MultirotorOptions& options);

  /// The same with the problems in the maps, the results of problemOf(): see explicitAxisLaw().
  MultirotorController(const std::array<const RegionMap*, 3>& maps, const std::array<MpcProblem, 3>& problems,
                       const MultirotorOptions& options);

  /// The same problems solved online, in the same order. Throws Error.
  MultirotorController(const std::array<MpcProblem, 3>& problems, const MultirotorOptions& options);

  /// One control period, with one reference for all of the horizon. Never throws, allocates, locks, logs or reads a clock.
  const ControlReport& step(const VehicleState& state, const Reference& reference) noexcept;

  /// The same with the reference of each stage, where the law looks ahead (previewLength() above 1).
  const ControlReport& step(const VehicleState& state, const Reference* preview) noexcept override;
  void track(const VehicleState& state, const AttitudeCommand& sent) noexcept override;
  void correct(const VehicleState& state, const AttitudeCommand& sent) noexcept override;
  void forget(LawMemory what) noexcept override;
  void setDisturbance(const Eigen::Vector3d& disturbance) noexcept override;
  void transferState(const ControlLaw& from) noexcept override;
  void inspect(const Reference* preview, LawInsight& insight) const noexcept override;

  const MultirotorOptions& options() const noexcept { return options_; }

 private:
  /// A sample in the world-aligned frame.
  struct Measured {
    TiltAngles tilt;  // body frame
    double yaw = 0.0;
    std::array<AxisSample, 3> axes;
  };

  MultirotorController(std::array<Axis, 3> axes, const MultirotorOptions& options);
  Measured measure(const VehicleState& state) const noexcept;
  void observe(const VehicleState& state, const Measured& measured) noexcept;
  void follow(const Reference& reference, double thrust, double yaw) noexcept;
  const ControlReport& answer(const VehicleState& state, const Reference& reference) noexcept;
  bool readStages() noexcept;
  ControlStatus evaluate(const Measured& measured, const Reference& reference,
                         ControlReason& reason) noexcept;
  std::array<double, 3> inputOffsets(const Measured& measured, const Reference& reference,
                                     const std::array<AxisReference, 3>& wanted) const noexcept;
  double nearBounds(const std::array<double, 2>& goals) const noexcept;
  void send(const TiltAngles& measured_tilt, double yaw, const Reference& reference) noexcept;
  TiltAngles added(const TiltAngles& tilt, double yaw_rate) const noexcept;
  TiltAngles forceAngles(const AttitudeCommand& command, const TiltAngles& measured_tilt) const noexcept;
  const ControlReport& cannotAnswer(ControlReason reason) noexcept;
  void resetObservers() noexcept override;
  void forgetPlan() noexcept override;

  std::array<Axis, 3> axes_;
  // References of the stages in this step; nullptr: one for all. Not owned.
  const Reference* preview_ = nullptr;
  // Sampling clock of minimum-peak maps.
  SamplingClock clock_;

  // Input u of each axis' model in the last command: u_{-1} of Eq. 4.
  std::array<double, 3> inputs_{};
  // Input u of each axis after the limits on what is sent, for the observer.
  std::array<double, 3> applied_{};
  // What gain and lag that were found added to the last command [rad].
  TiltAngles feed_forward_;
};

}  // namespace polyfly
