#pragma once

#include <string>
#include <vector>

#include "mpc_core/calibration_document.hpp"

namespace polyfly {

/// An options file of a node with numbers of calibrations in it.
struct AppliedOptions {
  /// Everything else as it was, comments too. The key `provenance` says where the numbers come from.
  std::string text;
  /// Sentences: which option, from what to what.
  std::vector<std::string> changes;
  /// True for the options of a fixed wing, false for those of a multirotor.
  bool fixed_wing = false;
};

/// Puts what was identified into the YAML file of a node's options. A file with the groups of a multirotor
/// (launch/config/firefly.yaml) takes:
///
/// - kind attitude: gain and tau of model_without_delay of roll and pitch as nonlinear/roll_gain, roll_time,
///   pitch_gain, pitch_time. Where the file states vehicle/delay, the laws predict over it: then those of model, and
///   the mean of their delays as vehicle/delay;
/// - kind drag: drag_forward, drag_left and drag_z, each above zero with its interval, as nonlinear/drag_x,
///   drag_y, drag_z;
/// - kind mass: mass as vehicle/mass, hover_command as output/hover_thrust;
/// - kind thrust: the curve as output/thrust_polynomial with output/attitude_target true, and the mass that its thrusts
///   were computed with as vehicle/mass. The file must state controller/thrust_min and thrust_max, between which the
///   curve must rise within 0 and 1.
///
/// A file with the groups of a fixed wing (launch/config/techpod.yaml) takes of kind attitude Eq. 45 of roll as
/// model/a0, a1, b0. Where it states guidance/applied_move 0, the guidance compensates a delay: then they are
/// those of the model with delay, with guidance/delay. Else they are those of the model without.
///
/// Missing options and groups are added. Ranges are the node's: see parseMultirotorParameters and
/// parseLateralParameters. Throws Error naming file, field and rule. Also when a calibration has nothing for these
/// options. Also when its data are those of another kind of vehicle, or do not support a number.
AppliedOptions applyToOptions(const std::string& options, const std::string& source,
                              const std::vector<CalibrationFile>& calibrations);

}  // namespace polyfly
