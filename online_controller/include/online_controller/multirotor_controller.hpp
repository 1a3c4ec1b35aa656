#pragma once

#include <array>
#include <string>

#include "online_controller/types.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

/// Vehicle and controller constants; each has a default (Firefly), a unit and a range, checked at construction.
/// Its owner completes it (observer weights, yaw gain, limits, periods).
struct MultirotorOptions {
  double mass = 1.52;               ///< [kg]
  double gravity = 9.8066;          ///< [m/s^2]
  double control_period = 0.01;     ///< nominal time between odometry messages [s]
  double yaw_gain = 1.8;            ///< K_yaw [1/s]
  double yaw_rate_max = 1.5707963;  ///< [rad/s]
  double angle_max = 0.4363323;     ///< on the command that is sent, after Eq. 41 [rad]
  double thrust_min = 5.0;          ///< mass-normalised [m/s^2]
  double thrust_max = 20.0;         ///< mass-normalised [m/s^2]
  int hold_periods = 10;            ///< samples without an answer during which the last command is repeated
  bool offset_free = true;          ///< use the disturbance estimate (Eq. 5-6)
};

/// Explicit linear MPC of a multirotor: three region maps (longitudinal, lateral, vertical), observer of Eq. 5, targets
/// of Eq. 6 in the frame that moves with the reference, world-to-body rotation of Eq. 40, compensation of Eq. 41.
/// Used alike by the nodelet and by the replay of a bag, so that both assemble the same parameters.
class MultirotorController {
 public:
  /// Maps in the order longitudinal, lateral, vertical; kept by reference. The model comes from the problem text in each map.
  /// Throws Error naming map, signal and rule when a map's signals are not those of its axis.
  MultirotorController(const std::array<const RegionMap*, 3>& maps, const MultirotorOptions& options);

  /// One control period. Never throws, allocates, locks, logs or reads a clock.
  const ControlReport& step(const VehicleState& state, const Reference& reference) noexcept;

  /// When odometry is silent at time `now` [s]: the safe command, with the reason.
  const ControlReport& onSilence(double now) noexcept;

  void reset() noexcept;
};

}  // namespace polyfly
