#pragma once

#include <array>

#include "online_controller/attitude.hpp"
#include "online_controller/axis.hpp"
#include "online_controller/options.hpp"
#include "online_controller/types.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

/// Explicit linear MPC of a multirotor: three region maps (longitudinal, lateral, vertical), observer of Eq.
/// 5, targets of Eq. 6 in the frame that moves with the reference, world-to-body rotation of Eq. 40,
/// compensation of Eq. 41. Used alike by the nodelet and by the replay of a bag, so that both assemble the
/// same parameters.
///
/// Each step answers with a finite command within the limits. Where the maps have no answer:
/// - a parameter out of its range is clipped to it and the law evaluated there (kClipped);
/// - no region, or NaN or absurd numbers in odometry or reference: the last command is repeated (kHoldLast)
/// for at
///   most options.hold_periods samples, then level attitude and hover thrust (kLevel);
/// - level at once when there is no command to repeat, and on silence;
/// - the next sample that has an answer ends it. Bad numbers never reach the observer.
///
/// The same calls after construction or reset give the same bits.
class MultirotorController {
 public:
  /// Maps in the order longitudinal, lateral, vertical; kept by reference. The model comes from the problem
  /// text in each map. Throws Error naming map, signal and rule when a map's signals are not those of its
  /// axis.
  MultirotorController(const std::array<const RegionMap*, 3>& maps, const MultirotorOptions& options);

  /// One control period. Never throws, allocates, locks, logs or reads a clock.
  const ControlReport& step(const VehicleState& state, const Reference& reference) noexcept;

  /// While there is nothing to track: level attitude, hover thrust (kNoReference). `stamp` is the odometry's.
  const ControlReport& stepWithoutReference(double stamp) noexcept;

  /// When odometry is silent at time `now` [s]: level attitude, hover thrust (kLevel), with the reason
  /// kStale. That the silence is long enough is for the caller to judge.
  const ControlReport& onSilence(double now) noexcept;

  /// As after construction.
  void reset() noexcept;

  const ControlReport& report() const noexcept { return report_; }  ///< of the last call
  const MultirotorOptions& options() const noexcept { return options_; }

 private:
  void observe(const VehicleState& state, const std::array<AxisSample, 3>& samples) noexcept;
  void send(const TiltAngles& measured_tilt, double yaw, const Reference& reference) noexcept;
  void withoutAnswer(ControlReason reason) noexcept;
  void level() noexcept;

  MultirotorOptions options_;
  std::array<Axis, 3> axes_;
  ControlReport report_;

  std::array<double, 3> inputs_{};   // u of each axis in the last command: u_{-1} of Eq. 4
  std::array<double, 3> applied_{};  // the same after the limits on what is sent: what the observer is told
  double observed_until_ = 0.0;      // time up to which the observer has advanced [s]
  bool observing_ = false;
  bool has_command_ = false;  // report_.command is an answer that may be repeated
  int unanswered_ = 0;        // samples in a row without an answer
};

}  // namespace polyfly
