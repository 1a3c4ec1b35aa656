#include "online_controller_ros/flight_display.hpp"

#include <tf2_msgs/TFMessage.h>
#include <trajectory_msgs/MultiDOFJointTrajectory.h>
#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <cmath>

namespace polyfly_ros {
namespace {

constexpr double kLineWidth = 0.02;  // [m]

geometry_msgs::Transform toTransform(const polyfly::Reference& reference) {
  geometry_msgs::Transform transform;
  transform.translation.x = reference.position.x();
  transform.translation.y = reference.position.y();
  transform.translation.z = reference.position.z();
  transform.rotation.z = std::sin(0.5 * reference.yaw);
  transform.rotation.w = std::cos(0.5 * reference.yaw);
  return transform;
}

template <class Vector>
void fill(const Eigen::Vector3d& from, Vector& to) {
  to.x = from.x();
  to.y = from.y();
  to.z = from.z();
}

/// Positions as predicted, with the reference's yaw, which the yaw controller follows beside the laws.
trajectory_msgs::MultiDOFJointTrajectory toPrediction(const FlightSnapshot& snapshot) {
  trajectory_msgs::MultiDOFJointTrajectory message;
  message.header = snapshot.answered.header;
  message.joint_names.emplace_back("base_link");
  const auto count = static_cast<std::size_t>(std::min(snapshot.predicted_count, snapshot.reference_count));
  message.points.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    polyfly::Reference stage;
    stage.position = snapshot.predicted[k];
    stage.yaw = snapshot.reference[k].yaw;
    message.points[k].transforms.push_back(toTransform(stage));
    message.points[k].time_from_start = ros::Duration(static_cast<double>(k) * snapshot.stage_period);
  }
  return message;
}

trajectory_msgs::MultiDOFJointTrajectory toMessage(const FlightSnapshot& snapshot) {
  const polyfly::Reference& reference = snapshot.reference.front();
  trajectory_msgs::MultiDOFJointTrajectory message;
  message.header = snapshot.answered.header;
  message.joint_names.emplace_back("base_link");
  message.points.resize(1);
  auto& point = message.points.front();
  point.transforms.push_back(toTransform(reference));
  point.velocities.resize(1);
  fill(reference.velocity, point.velocities.front().linear);
  point.velocities.front().angular.z = reference.yaw_rate;
  point.accelerations.resize(1);
  fill(reference.acceleration, point.accelerations.front().linear);
  return message;
}

visualization_msgs::Marker line(const std_msgs::Header& header, const char* name, float red, float green) {
  visualization_msgs::Marker marker;
  marker.header = header;
  marker.ns = name;
  marker.type = visualization_msgs::Marker::LINE_STRIP;
  marker.scale.x = kLineWidth;
  marker.pose.orientation.w = 1.0;
  marker.color.r = red;
  marker.color.g = green;
  marker.color.a = 1.0F;
  return marker;
}

void addPoint(const Eigen::Vector3d& position, visualization_msgs::Marker& marker) {
  if (!position.allFinite()) return;
  marker.points.emplace_back();
  fill(position, marker.points.back());
}

}  // namespace

FlightDisplay::FlightDisplay(ros::NodeHandle& handle)
    : tf_publisher_(handle.advertise<tf2_msgs::TFMessage>("/tf", 100)),
      reference_publisher_(
          handle.advertise<trajectory_msgs::MultiDOFJointTrajectory>("command/current_reference", 1)),
      reference_marker_publisher_(handle.advertise<visualization_msgs::Marker>("reference_trajectory", 1)),
      predicted_marker_publisher_(handle.advertise<visualization_msgs::Marker>("predicted_state", 1)),
      predicted_publisher_(
          handle.advertise<trajectory_msgs::MultiDOFJointTrajectory>("full_predicted_state", 1)),
      frame_(handle.resolveName("current_reference").substr(1)) {}

bool FlightDisplay::isWatched() const {
  return reference_marker_publisher_.getNumSubscribers() + predicted_marker_publisher_.getNumSubscribers() +
             predicted_publisher_.getNumSubscribers() >
         0;
}

void FlightDisplay::show(const FlightSnapshot& snapshot) {
  if (snapshot.reference_count == 0 || snapshot.answered.header.frame_id.empty()) return;
  tf2_msgs::TFMessage frames;
  frames.transforms.resize(1);
  frames.transforms.front().header = snapshot.answered.header;
  frames.transforms.front().child_frame_id = frame_;
  frames.transforms.front().transform = toTransform(snapshot.reference.front());
  tf_publisher_.publish(frames);
  if (reference_publisher_.getNumSubscribers() > 0) reference_publisher_.publish(toMessage(snapshot));
  if (snapshot.reference_count > 1 && reference_marker_publisher_.getNumSubscribers() > 0) {
    visualization_msgs::Marker marker = line(snapshot.answered.header, "reference", 0.0F, 1.0F);
    for (int k = 0; k < snapshot.reference_count; ++k)
      addPoint(snapshot.reference[static_cast<std::size_t>(k)].position, marker);
    reference_marker_publisher_.publish(marker);
  }
  if (snapshot.predicted_count > 1 && predicted_marker_publisher_.getNumSubscribers() > 0) {
    visualization_msgs::Marker marker = line(snapshot.answered.header, "prediction", 1.0F, 0.0F);
    for (int k = 0; k < snapshot.predicted_count; ++k)
      addPoint(snapshot.predicted[static_cast<std::size_t>(k)], marker);
    predicted_marker_publisher_.publish(marker);
  }
  if (snapshot.predicted_count > 1 && predicted_publisher_.getNumSubscribers() > 0)
    predicted_publisher_.publish(toPrediction(snapshot));
}

}  // namespace polyfly_ros
