#pragma once

#include <string>
#include <vector>

#include "identification/attitude_output.hpp"
#include "validation/report.hpp"

namespace polyfly {

/// The figures of one axis: intervals used; measurement, model and residuals for identification and for validation.
std::vector<ReportFigure> identificationFigures(const AxisModel& axis);

/// The page as one HTML text with its pictures inside. Runs gnuplot. Throws Error.
std::string toHtml(const AttitudeCalibration& calibration);

/// Writes `index.html` and `calibration.yaml` into the folder, which is made where it is missing. Throws
/// Error naming the file.
void writeReport(const AttitudeCalibration& calibration, const std::string& folder);

}  // namespace polyfly
