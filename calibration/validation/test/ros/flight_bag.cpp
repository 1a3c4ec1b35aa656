#include "flight_bag.hpp"

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/Vector3Stamped.h>
#include <mav_msgs/RollPitchYawrateThrust.h>
#include <nav_msgs/Odometry.h>
#include <online_controller/ControllerStatus.h>
#include <std_msgs/String.h>

#include <algorithm>
#include <functional>
#include <map>

namespace polyfly_ros {
namespace {

using polyfly::FlightLog;

nav_msgs::Odometry odometryOf(const polyfly::VehicleState& state) {
  nav_msgs::Odometry message;
  message.header.stamp = ros::Time(state.stamp);
  message.pose.pose.position.x = state.position.x();
  message.pose.pose.position.y = state.position.y();
  message.pose.pose.position.z = state.position.z();
  message.pose.pose.orientation.w = state.attitude.w();
  message.pose.pose.orientation.x = state.attitude.x();
  message.pose.pose.orientation.y = state.attitude.y();
  message.pose.pose.orientation.z = state.attitude.z();
  const Eigen::Vector3d velocity = state.attitude.conjugate() * state.velocity;
  message.twist.twist.linear.x = velocity.x();
  message.twist.twist.linear.y = velocity.y();
  message.twist.twist.linear.z = velocity.z();
  message.twist.twist.angular.x = state.angular_velocity.x();
  message.twist.twist.angular.y = state.angular_velocity.y();
  message.twist.twist.angular.z = state.angular_velocity.z();
  return message;
}

geometry_msgs::PoseStamped poseOf(const polyfly::ReferenceTrajectory& reference) {
  const polyfly::Reference held = reference.sample(0.0);
  geometry_msgs::PoseStamped message;
  message.pose.position.x = held.position.x();
  message.pose.position.y = held.position.y();
  message.pose.position.z = held.position.z();
  message.pose.orientation.w = 1.0;
  return message;
}

mav_msgs::RollPitchYawrateThrust commandOf(const FlightLog::Command& command) {
  mav_msgs::RollPitchYawrateThrust message;
  message.header.stamp = ros::Time(command.stamp);
  message.roll = command.command.roll;
  message.pitch = command.command.pitch;
  message.yaw_rate = command.command.yaw_rate;
  message.thrust.z = command.command.thrust;
  return message;
}

online_controller::ControllerStatus statusOf(const FlightLog::Status& status) {
  online_controller::ControllerStatus message;
  message.header.stamp = ros::Time(status.stamp);
  message.sequence = status.sequence;
  message.status = static_cast<std::uint8_t>(status.status);
  message.reason = static_cast<std::uint8_t>(status.reason);
  message.step_time_ns = static_cast<std::int64_t>(1e9 * status.step_time);
  online_controller::AxisStatus* axes[3] = {&message.longitudinal, &message.lateral, &message.vertical};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    axes[axis]->region = status.region[axis];
    axes[axis]->input = status.input[axis];
    axes[axis]->theta = status.theta[axis];
  }
  return message;
}

}  // namespace

void writeFlight(const FlightLog& log, const FlightBagOptions& options, rosbag::Bag* bag) {
  // In the order of arrival, as a recorder writes.
  std::multimap<ros::Time, std::function<void(const ros::Time&)>> arrivals;
  const auto arrive = [&](const ros::Time& time, const std::string& topic, const auto& message) {
    arrivals.emplace(time, [bag, name = options.name_space + "/" + topic,
                            message](const ros::Time& received) { bag->write(name, received, message); });
  };
  ros::Time now(log.odometry.empty() ? 1.0 : log.odometry.front().stamp);
  for (const FlightLog::Event& event : log.events) {
    if (event.kind == FlightLog::EventKind::kOdometry) {
      now = ros::Time(log.odometry[event.index].stamp);
      if (options.odometry) arrive(now, "odometry", odometryOf(log.odometry[event.index]));
    } else if (event.kind == FlightLog::EventKind::kReference && options.references) {
      arrive(now, "command/pose", poseOf(log.references[event.index].trajectory));
    }
  }
  for (const FlightLog::Parameters& told : log.parameters) {
    std_msgs::String message;
    message.data = told.text;
    arrive(ros::Time(told.time), "controller/parameters_in_force", message);
  }
  const ros::Duration shift(options.arrival_shift);
  for (const FlightLog::Command& command : log.commands) {
    if (!options.commands) break;
    arrive(ros::Time(command.stamp) + shift, "command/roll_pitch_yawrate_thrust", commandOf(command));
  }
  for (const FlightLog::Status& status : log.statuses) {
    if (!options.statuses) break;
    arrive(ros::Time(status.stamp) + shift, "controller_status", statusOf(status));
  }
  for (const FlightLog::Disturbance& disturbance : log.disturbances) {
    geometry_msgs::Vector3Stamped message;
    message.header.stamp = ros::Time(disturbance.stamp);
    message.vector.x = disturbance.acceleration.x();
    message.vector.y = disturbance.acceleration.y();
    message.vector.z = disturbance.acceleration.z();
    arrive(message.header.stamp, "ground_truth/disturbance", message);
  }
  ros::Time last = ros::TIME_MIN;
  for (const auto& [time, write] : arrivals) {
    double late = 0.0;
    for (const auto& [from, by] : options.late) late = time.toSec() >= from ? by : late;
    last = std::max(last, time + ros::Duration(late));
    write(last);
  }
}

void writeFlightBag(const FlightLog& log, const std::string& path, const FlightBagOptions& options) {
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  bag.setCompression(options.compression);
  bag.setChunkThreshold(options.chunk_threshold);
  writeFlight(log, options, &bag);
  bag.close();
}

}  // namespace polyfly_ros
