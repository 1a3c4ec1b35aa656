#pragma once

#include <string>
#include <vector>

#include "mpc_core/calibration_document.hpp"

namespace polyfly {

/// Node whose options are asked for.
struct OptionsTarget {
  /// multirotor or fixed_wing.
  std::string vehicle;
  /// True: the controller predicts over the delay, so that the lag does not hold it.
  bool predicts_delay = false;
};

/// What was identified, as a block of YAML to paste into a node's options, with the key `provenance`. A multirotor
/// (launch/config/firefly.yaml) takes:
///
/// - kind attitude: gain and tau of model_without_delay of roll and pitch as nonlinear/roll_gain, roll_time, pitch_gain,
///   pitch_time. Where the delay is predicted: those of model, and the mean of their delays as vehicle/delay;
/// - kind drag: drag_forward, drag_left and drag_z, each above zero with its interval, as nonlinear/drag_x, drag_y, drag_z;
/// - kind mass: mass as vehicle/mass, hover_command as output/hover_thrust.
///
/// A fixed wing (launch/config/techpod.yaml) takes of kind attitude Eq. 45 of roll as model/a0, a1, b0, without delay.
///
/// Throws Error naming file, field and rule where a calibration has nothing for these options, is of another kind of
/// vehicle, or its data do not support a number.
std::string optionsBlock(const OptionsTarget& target, const std::vector<CalibrationFile>& calibrations);

}  // namespace polyfly
