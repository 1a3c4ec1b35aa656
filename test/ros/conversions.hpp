#pragma once

#include <geometry_msgs/Vector3Stamped.h>
#include <mav_msgs/RollPitchYawrateThrust.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <ros/time.h>
#include <trajectory_msgs/MultiDOFJointTrajectory.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "online_controller/types/types.hpp"
#include "polyfly_test/multirotor_plant.hpp"

namespace polyfly_ros {

/// A time on the flight's grid: `start` and `seconds` more, rounded to a nanosecond.
ros::Time addSeconds(const ros::Time& start, double seconds);

/// Pose in `frame`, twist in `child_frame` (the body), as nav_msgs/Odometry demands.
nav_msgs::Odometry toOdometry(const polyfly::VehicleState& state, const ros::Time& stamp,
                              const std::string& frame, const std::string& child_frame);

geometry_msgs::Vector3Stamped toVector(const Eigen::Vector3d& vector, const ros::Time& stamp,
                                       const std::string& frame);

polyfly::AttitudeCommand fromCommand(const mav_msgs::RollPitchYawrateThrust& message);

/// One point per reference, `period` seconds apart.
trajectory_msgs::MultiDOFJointTrajectory toTrajectory(const std::vector<polyfly::Reference>& points,
                                                      double period, const ros::Time& stamp,
                                                      const std::string& frame);

/// The positions of a trajectory, for rviz.
nav_msgs::Path toPath(const trajectory_msgs::MultiDOFJointTrajectory& trajectory);

/// The vehicle hovering at the trajectory's first point. Throws Error when the trajectory has no finite first
/// point.
polyfly::PlantState startOf(const trajectory_msgs::MultiDOFJointTrajectory& trajectory, double gravity);

}  // namespace polyfly_ros
