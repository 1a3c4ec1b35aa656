#pragma once

#include <string>
#include <vector>

#include "identification/motion.hpp"
#include "identification/provenance.hpp"

namespace polyfly {

/// What `calibrate disturbance`, `drag`, `mass` or `wind` found; bounds of the first, parameters of the
/// others.
struct MotionCalibration {
  std::string kind;
  Provenance data;
  std::vector<std::string> remarks;  ///< sentences: what was wrong with the file
  std::vector<TimeWindow> windows;   ///< empty: the whole record
  BoundOptions limits;
  std::vector<DisturbanceBound> bounds;
  std::vector<FittedParameter> parameters;
  std::vector<std::string> warnings;  ///< sentences

  // For the pictures of the report; not in YAML or text.
  std::vector<MotionTrace> traces;
  std::vector<std::pair<std::string, TimeSeries>> record;  ///< velocities, whole, by name [m/s]
  std::vector<double> north, east;                         ///< of `wind`: velocity over ground [m/s]
};

/// As YAML; `disturbances` of a bound has the form that problem and model files take. The same input gives
/// the same bytes.
std::string toYaml(const MotionCalibration& calibration);

/// For people.
std::string toText(const MotionCalibration& calibration);

}  // namespace polyfly
