#pragma once

#include <Eigen/Core>

#include "online_controller/types/flight_options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// The pilot's sticks, each in [-1, 1] and positive as named, in the frame of the body.
struct RemoteControl {
  enum class Mode { kManual, kAltitude, kPosition };

  bool on = false;
  Mode mode = Mode::kManual;
  double forward = 0.0;
  double left = 0.0;
  double up = 0.0;
  /// Turn, positive to the left.
  double turn = 0.0;
};

/// 0 within +-`zone`, then linear to +-1; what is not finite is 0.
double beyondDeadzone(double stick, double zone) noexcept;

/// A stick is out of the dead zone.
bool isActive(const RemoteControl& sticks, double zone) noexcept;

/// The sticks as attitude and thrust: full stick is rc_max_roll_pitch_command, rc_max_yaw_rate_command;
/// thrust from 0 to 1.6 times that of hovering, within the limit.
AttitudeCommand manualCommand(const RemoteControl& sticks, const FlightOptions& options,
                              const MultirotorOptions& vehicle) noexcept;

/// The pose that the sticks ask for. The axes are horizontal plane, height and yaw. Where a stick is out of the dead
/// zone, the pose is up to rc_teleop_max_carrot_distance ahead of the vehicle. In the other axes it is that of
/// `held`.
Reference carrot(const RemoteControl& sticks, const VehicleState& state, const Reference& held,
                 const FlightOptions& options) noexcept;

}  // namespace polyfly
