#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/calibration_file.hpp"
#include "identification/identify_axis.hpp"

namespace polyfly {

/// What one run of `calibrate attitude` found.
struct AttitudeCalibration : CalibrationFlights {
  std::optional<Provenance> validation;
  std::vector<AxisModel> axes;
  std::vector<std::string> failed;  ///< sentences: axes that could not be identified
};

/// The content of the calibration file, keys explained in README.md.
Json jsonOf(const AttitudeCalibration& calibration);

/// The numbers for people, with the warnings.
std::string toText(const AttitudeCalibration& calibration);

/// The page, with the intervals used, and measurement, models and residuals for identification and validation.
Report reportOn(const AttitudeCalibration& calibration);

/// The answer on an axis in one line, and in another one how sure it is.
std::string answerOf(const AxisModel& axis);

}  // namespace polyfly
