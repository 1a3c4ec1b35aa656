#pragma once

#include <string>
#include <vector>

#include "identification/calibration_file.hpp"
#include "identification/motion.hpp"

namespace polyfly {

/// What `calibrate disturbance`, `drag` or `mass` found; bounds of the first, parameters of the others.
struct MotionCalibration : CalibrationFlights {
  std::string kind;
  /// Windows that were used, one list for each flight. Empty: the whole record.
  std::vector<std::vector<TimeWindow>> windows;
  BoundOptions limits;
  std::vector<DisturbanceBound> bounds;
  /// Parameters of drag or mass; of a disturbance only pictures and warnings.
  MotionFit fit;
  /// Velocities of the whole record of a single flight, by name [m/s]; for the page only.
  std::vector<std::pair<std::string, TimeSeries>> record;
};

/// The content of the calibration file; `disturbances` of a bound has the form that problem and model files take.
Json jsonOf(const MotionCalibration& calibration);

/// For people.
std::string toText(const MotionCalibration& calibration);

/// The page, with the data used, measurement and model over time, and what is left.
Report reportOn(const MotionCalibration& calibration);

}  // namespace polyfly
