#pragma once

#include <string>
#include <vector>

#include "identification/motion_output.hpp"
#include "validation/report.hpp"

namespace polyfly {

/// The pictures of a disturbance, drag or mass. One shows what was used of the flight. Each trace has measured
/// against model over time, with residuals.
std::vector<ReportFigure> motionFigures(const MotionCalibration& calibration);

/// The page as one HTML text with its pictures inside. Runs gnuplot. Throws Error.
std::string toHtml(const MotionCalibration& calibration);

/// Writes `index.html` and `calibration.yaml` into the folder, which is made where it is missing. Throws
/// Error naming the file.
void writeReport(const MotionCalibration& calibration, const std::string& folder);

}  // namespace polyfly
