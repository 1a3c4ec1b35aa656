#pragma once

#include <rosbag/bag.h>

#include <string>
#include <vector>

#include "calibration/replay.hpp"
#include "calibration/validation.hpp"

namespace polyfly_ros {

/// A bag that shows a validation in rqt and rviz, at the times of the flight's odometry. Below /validation,
/// for each axis AXIS (longitudinal, lateral, vertical):
///
/// - AXIS/inside (std_msgs/Float64): 1 where the map held the parameters, else 0
/// - AXIS/region (std_msgs/Float64): number of the region, -1 where there is none
/// - AXIS/face_distance, AXIS/edge_distance, AXIS/qp_difference (std_msgs/Float64): where the map held them
/// - tracking_error (std_msgs/Float64) [m]
/// - markers (visualization_msgs/Marker, frame "world"): the path flown, green inside all maps, red outside;
///   written at the end of each flight
class ValidationTopics {
 public:
  /// Throws polyfly::Error naming the file when it cannot be made.
  explicit ValidationTopics(const std::string& path);

  void write(const std::vector<polyfly::ReplaySample>& samples, const polyfly::ValidationReport& report);
  void close();

 private:
  void writeAxis(const std::vector<polyfly::ReplaySample>& samples, const polyfly::AxisValidation& axis,
                 std::size_t index);
  void writePath(const std::vector<polyfly::ReplaySample>& samples);
  void number(const std::string& topic, double stamp, double value);

  std::string path_;
  rosbag::Bag bag_;
};

}  // namespace polyfly_ros
