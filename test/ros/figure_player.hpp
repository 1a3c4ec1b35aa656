#pragma once

#include <ros/ros.h>
#include <trajectory_msgs/MultiDOFJointTrajectory.h>

namespace polyfly_ros {

/// Publishes the flight figure once, as a trajectory that starts at a given simulated time, when enough
/// subscribers are there. Topics and parameters: test/README.md.
class FigurePlayer {
 public:
  /// Throws polyfly::Error when a parameter breaks its rule.
  FigurePlayer(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);

 private:
  void publishWhenHeard();

  ros::NodeHandle nh_;
  trajectory_msgs::MultiDOFJointTrajectory trajectory_;
  int subscribers_ = 1;
  ros::Publisher trajectory_pub_;
  ros::Publisher path_pub_;
  ros::WallTimer timer_;
};

}  // namespace polyfly_ros
