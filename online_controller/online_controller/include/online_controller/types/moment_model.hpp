#pragma once

#include "polyfly_base/range.hpp"

namespace polyfly {

/// The attitude loops as an observer of moments sees them, with the names and defaults of mav_control_rw. About roll
/// and pitch, angle'' = omega^2 (gain command - angle) - 2 damping omega angle' + moment. About yaw, whose command is
/// a rate, rate' = omega (gain command - rate) + moment.
struct MomentModel {
  double roll_omega = 7.07;    ///< [rad/s]
  double roll_damping = 0.72;  ///< [1]
  double roll_gain = 0.8;      ///< [1]
  double pitch_omega = 7.07;
  double pitch_damping = 0.76;
  double pitch_gain = 0.84;
  double yaw_omega = 5.0;
  double yaw_gain = 1.0;
  double calibration_duration = 5.0;  ///< [s]
};

template <class Options, class Visit>
void visitMomentModel(Options& options, Visit&& visit) {
  visit("KF_observer/roll_omega", options.roll_omega, "rad/s", Range{0.1, 100.0});
  visit("KF_observer/roll_damping", options.roll_damping, "1", Range{0.05, 10.0});
  visit("KF_observer/roll_gain", options.roll_gain, "1", Range{0.01, 10.0});
  visit("KF_observer/pitch_omega", options.pitch_omega, "rad/s", Range{0.1, 100.0});
  visit("KF_observer/pitch_damping", options.pitch_damping, "1", Range{0.05, 10.0});
  visit("KF_observer/pitch_gain", options.pitch_gain, "1", Range{0.01, 10.0});
  visit("KF_observer/yaw_omega", options.yaw_omega, "rad/s", Range{0.1, 100.0});
  visit("KF_observer/yaw_gain", options.yaw_gain, "1", Range{0.01, 10.0});
  visit("KF_observer/calibration_duration", options.calibration_duration, "s", Range{0.1, 1000.0});
}

/// Throws Error naming the key, its range and its value.
void checkMomentModel(const MomentModel& moments);

}  // namespace polyfly
