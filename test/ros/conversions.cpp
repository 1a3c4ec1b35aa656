#include "conversions.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>

#include "polyfly_base/error.hpp"

namespace polyfly_ros {
namespace {

geometry_msgs::Vector3 toMessage(const Eigen::Vector3d& vector) {
  geometry_msgs::Vector3 message;
  message.x = vector.x();
  message.y = vector.y();
  message.z = vector.z();
  return message;
}

}  // namespace

ros::Time addSeconds(const ros::Time& start, double seconds) {
  const std::int64_t sum = static_cast<std::int64_t>(start.toNSec()) + std::llround(seconds * 1e9);
  ros::Time time;
  return time.fromNSec(static_cast<std::uint64_t>(sum));
}

nav_msgs::Odometry toOdometry(const polyfly::VehicleState& state, const ros::Time& stamp,
                              const std::string& frame, const std::string& child_frame) {
  nav_msgs::Odometry message;
  message.header.stamp = stamp;
  message.header.frame_id = frame;
  message.child_frame_id = child_frame;
  message.pose.pose.position.x = state.position.x();
  message.pose.pose.position.y = state.position.y();
  message.pose.pose.position.z = state.position.z();
  message.pose.pose.orientation.w = state.attitude.w();
  message.pose.pose.orientation.x = state.attitude.x();
  message.pose.pose.orientation.y = state.attitude.y();
  message.pose.pose.orientation.z = state.attitude.z();
  message.twist.twist.linear = toMessage(state.attitude.conjugate() * state.velocity);
  message.twist.twist.angular = toMessage(state.angular_velocity);
  return message;
}

geometry_msgs::Vector3Stamped toVector(const Eigen::Vector3d& vector, const ros::Time& stamp,
                                       const std::string& frame) {
  geometry_msgs::Vector3Stamped message;
  message.header.stamp = stamp;
  message.header.frame_id = frame;
  message.vector = toMessage(vector);
  return message;
}

polyfly::AttitudeCommand fromCommand(const mav_msgs::RollPitchYawrateThrust& message) {
  polyfly::AttitudeCommand command;
  command.roll = message.roll;
  command.pitch = message.pitch;
  command.yaw_rate = message.yaw_rate;
  command.thrust = message.thrust.z;
  return command;
}

trajectory_msgs::MultiDOFJointTrajectory toTrajectory(const std::vector<polyfly::Reference>& points,
                                                      double period, const ros::Time& stamp,
                                                      const std::string& frame) {
  trajectory_msgs::MultiDOFJointTrajectory message;
  message.header.stamp = stamp;
  message.header.frame_id = frame;
  message.joint_names.push_back("base_link");
  message.points.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    trajectory_msgs::MultiDOFJointTrajectoryPoint& point = message.points[i];
    geometry_msgs::Transform pose;
    pose.translation = toMessage(points[i].position);
    pose.rotation.w = std::cos(0.5 * points[i].yaw);
    pose.rotation.z = std::sin(0.5 * points[i].yaw);
    geometry_msgs::Twist velocity;
    velocity.linear = toMessage(points[i].velocity);
    velocity.angular.z = points[i].yaw_rate;
    geometry_msgs::Twist acceleration;
    acceleration.linear = toMessage(points[i].acceleration);
    point.transforms.push_back(pose);
    point.velocities.push_back(velocity);
    point.accelerations.push_back(acceleration);
    point.time_from_start.fromNSec(std::llround(static_cast<double>(i) * period * 1e9));
  }
  return message;
}

nav_msgs::Path toPath(const trajectory_msgs::MultiDOFJointTrajectory& trajectory) {
  nav_msgs::Path path;
  path.header = trajectory.header;
  for (const trajectory_msgs::MultiDOFJointTrajectoryPoint& point : trajectory.points) {
    geometry_msgs::PoseStamped pose;
    pose.header = trajectory.header;
    pose.header.stamp += point.time_from_start;
    pose.pose.position.x = point.transforms[0].translation.x;
    pose.pose.position.y = point.transforms[0].translation.y;
    pose.pose.position.z = point.transforms[0].translation.z;
    pose.pose.orientation = point.transforms[0].rotation;
    path.poses.push_back(pose);
  }
  return path;
}

polyfly::PlantState startOf(const trajectory_msgs::MultiDOFJointTrajectory& trajectory, double gravity) {
  if (trajectory.points.empty() || trajectory.points[0].transforms.empty()) {
    throw polyfly::Error("command/trajectory: must have a first point with a transform");
  }
  const geometry_msgs::Transform& pose = trajectory.points[0].transforms[0];
  polyfly::PlantState state;
  state.position = Eigen::Vector3d(pose.translation.x, pose.translation.y, pose.translation.z);
  state.yaw = 2.0 * std::atan2(pose.rotation.z, pose.rotation.w);
  state.thrust = gravity;
  return state;
}

}  // namespace polyfly_ros
