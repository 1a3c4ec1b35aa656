#pragma once

#include <array>
#include <optional>

#include "mpc_core/observer.hpp"
#include "online_controller/attitude.hpp"
#include "online_controller/options.hpp"
#include "online_controller/types.hpp"

namespace polyfly {

/// angle' = (gain command - angle) / time about roll and pitch, as the law predicts them.
struct TiltModel {
  double roll_gain = 0.9;    ///< [1]
  double roll_time = 0.25;   ///< [s]
  double pitch_gain = 0.9;   ///< [1]
  double pitch_time = 0.25;  ///< [s]
};

/// The roll and pitch commands at which odometry sees the vehicle level: those of the options and what a
/// Kalman filter finds beside them, for which the attitude is measured and compared with what the commands
/// should have made of it. So neither an inner loop of another gain, nor a frame that is not aligned, nor a
/// centre of mass off the middle (an external moment) leaves an offset: an estimate of the force alone cannot
/// explain them.
///
/// About the axes of the body. Estimates of more than kMost are none: the vehicle is held by something.
class AttitudeTrim {
 public:
  static constexpr double kMost = 0.1;  ///< of what is found [rad]

  /// Finds nothing with options.trim_drift 0 or options.offset_free unset. Throws Error when the model's
  /// times or gains are not above 0.
  AttitudeTrim(const TiltModel& model, const MultirotorOptions& options);

  /// Roll and pitch were measured `periods` control periods after the last time; meanwhile `held` was the
  /// command.
  void update(const TiltAngles& measured, const AttitudeCommand& held, int periods) noexcept;

  void reset() noexcept;
  void takeOver(const AttitudeTrim& other) noexcept;

  TiltAngles angles() const noexcept;  ///< to be added to a command [rad]

 private:
  TiltAngles given_;
  std::optional<std::array<DisturbanceObserver, 2>> loops_;  // roll, pitch
};

}  // namespace polyfly
