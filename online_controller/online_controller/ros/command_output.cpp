#include "online_controller_ros/command_output.hpp"

#include <boost/make_shared.hpp>
#include <cmath>
#include <limits>

#include "online_controller_ros/conversions.hpp"

namespace polyfly_ros {
namespace {

constexpr std::uint32_t kQueue = 10;  // a recorder over TCP may lag behind for a moment

template <class Message>
void make(boost::shared_ptr<Message>& message) {
  if (!message) message = boost::make_shared<Message>();
}

/// The message made beforehand, or else a new one, with its header.
template <class Message>
Message& taken(boost::shared_ptr<Message>& message, const std_msgs::Header& header) {
  make(message);
  message->header = header;
  return *message;
}

}  // namespace

CommandOutput::CommandOutput(ros::NodeHandle& handle, const polyfly::OutputOptions& options,
                             const polyfly::MultirotorOptions& vehicle)
    : yaw_(std::numeric_limits<double>::quiet_NaN()) {
  if (options.roll_pitch_yawrate_thrust) {
    thrust_publisher_ =
        handle.advertise<mav_msgs::RollPitchYawrateThrust>("command/roll_pitch_yawrate_thrust", kQueue);
  }
  if (!options.attitude_target) return;
  curve_.emplace(options.thrust, vehicle.mass * vehicle.thrust_min, vehicle.mass * vehicle.thrust_max,
                 vehicle.mass * vehicle.gravity);
  target_publisher_ = handle.advertise<mavros_msgs::AttitudeTarget>("mavros/setpoint_raw/attitude", kQueue);
}

void CommandOutput::publish(const polyfly::AttitudeCommand& command, const std_msgs::Header& header,
                            double yaw) {
  if (thrust_publisher_) {
    fillCommand(command, taken(next_thrust_, header));
    thrust_publisher_.publish(next_thrust_);
    next_thrust_.reset();
  }
  if (!curve_) return;
  if (std::isfinite(yaw)) yaw_ = yaw;
  if (!std::isfinite(yaw_)) return;
  fillAttitudeTarget(command, yaw_, *curve_, taken(next_target_, header));
  target_publisher_.publish(next_target_);
  next_target_.reset();
}

void CommandOutput::prepare() {
  if (thrust_publisher_) make(next_thrust_);
  if (target_publisher_) make(next_target_);
}

}  // namespace polyfly_ros
