#pragma once

#include <string>
#include <vector>

#include "mpc_core/calibration_document.hpp"

namespace polyfly {

/// A problem file with numbers of calibrations in it.
struct AppliedCalibration {
  std::string problem;               ///< text: everything else as it was, `provenance` at the end
  std::vector<std::string> changes;  ///< one sentence each: which field, from what to what, from which file
};

/// Puts what was identified into a problem file (region_maps/problems/README.md), tracking_mpc or robust_mpc:
///
/// - kind attitude: gain and tau of model_without_delay, of roll where the input is phi_cmd, of pitch where it
///   is theta_cmd: the row of the lag state in A and B (Eq. 37). Where the file states model.delay, the controller
///   predicts over it: then gain, tau and delay of model;
/// - kind drag: minus drag_x, drag_y or drag_z on the diagonal of A, in the row of the state whose error
///   is the parameter e_v_x, e_v_y or e_v_z; each must be above zero with its interval;
/// - kind disturbance: the range of the disturbance that ends in _x, _y or _z, where the problem bounds it.
///
/// The numbers are written into the text, so a map carries them and where they come from. The key `provenance` lists
/// each file, its checksum, its data and the fields. Throws Error naming file, field and rule. It throws when a
/// calibration has nothing for this problem, and when its data are those of a fixed wing. It throws when they do not
/// support a number that the problem would take (`supported` is not true), and when the result is no problem.
AppliedCalibration applyCalibrations(const std::string& problem, const std::string& source,
                                     const std::vector<CalibrationFile>& calibrations);

}  // namespace polyfly
