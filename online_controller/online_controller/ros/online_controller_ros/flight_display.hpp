#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <string>

#include "online_controller_ros/flight_record.hpp"

namespace polyfly_ros {

/// Shows a flight: the reference as a tf2 frame, reference and prediction as markers for rviz, the prediction
/// as a trajectory too. Lives in the other thread and works on snapshots.
class FlightDisplay {
 public:
  explicit FlightDisplay(ros::NodeHandle& handle);

  /// Whether a path topic has subscribers. Without them, snapshots need no paths.
  bool isWatched() const;

  void show(const FlightSnapshot& snapshot);

 private:
  ros::Publisher tf_publisher_;
  ros::Publisher reference_publisher_;
  ros::Publisher reference_marker_publisher_;
  ros::Publisher predicted_marker_publisher_;
  ros::Publisher predicted_publisher_;
  // Frame of the reference.
  std::string frame_;
};

}  // namespace polyfly_ros
