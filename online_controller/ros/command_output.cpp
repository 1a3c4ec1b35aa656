#include "online_controller_ros/command_output.hpp"

#include <boost/make_shared.hpp>
#include <cmath>
#include <limits>

#include "online_controller_ros/conversions.hpp"
#include "region_maps/error.hpp"

namespace polyfly_ros {
namespace {

constexpr std::uint32_t kQueue = 10;  // a recorder over TCP may lag behind for a moment

}  // namespace

OutputOptions OutputOptions::read(ParameterReader& reader) {
  OutputOptions options;
  reader("output/roll_pitch_yawrate_thrust", options.roll_pitch_yawrate_thrust);
  reader("output/attitude_target", options.attitude_target);
  reader("output/hover_thrust", options.thrust.hover_thrust, "", polyfly::Range{0.01, 0.99});
  reader("output/thrust_least", options.thrust.least, "", polyfly::Range{0.0, 1.0});
  reader("output/thrust_greatest", options.thrust.greatest, "", polyfly::Range{0.0, 1.0});
  reader("output/thrust_polynomial", options.thrust.polynomial);
  if (!options.roll_pitch_yawrate_thrust && !options.attitude_target)
    throw polyfly::Error("output: one of roll_pitch_yawrate_thrust and attitude_target must be true");
  return options;
}

CommandOutput::CommandOutput(ros::NodeHandle& handle, const OutputOptions& options,
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
    const auto message = boost::make_shared<mav_msgs::RollPitchYawrateThrust>();
    message->header = header;
    fillCommand(command, *message);
    thrust_publisher_.publish(message);
  }
  if (!curve_) return;
  if (std::isfinite(yaw)) yaw_ = yaw;
  if (!std::isfinite(yaw_)) return;
  const auto message = boost::make_shared<mavros_msgs::AttitudeTarget>();
  message->header = header;
  fillAttitudeTarget(command, yaw_, *curve_, *message);
  target_publisher_.publish(message);
}

}  // namespace polyfly_ros
