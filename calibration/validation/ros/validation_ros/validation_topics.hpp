#pragma once

#include <string>
#include <vector>

#include "validation/replay.hpp"
#include "validation/validation.hpp"

namespace polyfly_ros {

/// What the bag of topics needs of a flight. References: they must stay valid until it is written.
struct ValidatedFlight {
  const std::vector<polyfly::ReplaySample>& samples;
  const polyfly::ValidationReport& report;
};

/// Writes a bag that shows a validation in rqt, at the times of the flights' odometry. Below /validation,
/// for each axis AXIS (longitudinal, lateral, vertical):
///
/// - AXIS/inside (std_msgs/Float64): 1 where the map held the parameters, else 0
/// - AXIS/region (std_msgs/Float64): number of the region, -1 where there is none
/// - AXIS/face_distance, AXIS/edge_distance, AXIS/qp_difference (std_msgs/Float64): where the map held them
/// - tracking_error (std_msgs/Float64) [m]
///
/// Throws polyfly::Error naming the file when it cannot be written; what was there stays then.
void writeValidationTopics(const std::vector<ValidatedFlight>& flights, const std::string& path);

}  // namespace polyfly_ros
