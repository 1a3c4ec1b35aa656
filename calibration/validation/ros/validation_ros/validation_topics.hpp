#pragma once

#include <rosbag/bag.h>

#include <memory>
#include <string>
#include <vector>

#include "polyfly_base/file_draft.hpp"
#include "validation/replay.hpp"
#include "validation/validation.hpp"

namespace polyfly_ros {

/// A bag that shows a validation in rqt, at the times of the flight's odometry. Below /validation,
/// for each axis AXIS (longitudinal, lateral, vertical):
///
/// - AXIS/inside (std_msgs/Float64): 1 where the map held the parameters, else 0
/// - AXIS/region (std_msgs/Float64): number of the region, -1 where there is none
/// - AXIS/face_distance, AXIS/edge_distance, AXIS/qp_difference (std_msgs/Float64): where the map held them
/// - tracking_error (std_msgs/Float64) [m]
///
/// Everything throws polyfly::Error naming the file when it cannot be written; what was there stays then.
class ValidationTopics {
 public:
  explicit ValidationTopics(const std::string& path);
  ValidationTopics(const ValidationTopics&) = delete;
  ValidationTopics& operator=(const ValidationTopics&) = delete;
  ~ValidationTopics();

  void write(const std::vector<polyfly::ReplaySample>& samples, const polyfly::ValidationReport& report);
  /// The file takes its place. Nothing else may follow.
  void close();

 private:
  void writeAxis(const std::vector<polyfly::ReplaySample>& samples, const polyfly::AxisValidation& axis,
                 std::size_t index);
  void number(const std::string& topic, double stamp, double value);
  void abandonBag();
  void closeBag();
  [[noreturn]] void fail(const rosbag::BagException& failure) const;

  std::string path_;
  polyfly::FileDraft draft_;
  std::unique_ptr<rosbag::Bag> bag_ = std::make_unique<rosbag::Bag>();
};

}  // namespace polyfly_ros
