#include "excitation_ros/excite_node.hpp"

#include <geometry_msgs/PointStamped.h>
#include <mav_msgs/RollPitchYawrateThrust.h>
#include <std_msgs/String.h>

#include <sstream>

#include "fixedwing_lateral_ros/conversions.hpp"
#include "online_controller/types/attitude.hpp"
#include "online_controller_ros/conversions.hpp"
#include "polyfly_ros/parameter_reader.hpp"

namespace polyfly_ros {
namespace {

constexpr std::uint32_t kQueue = 100;
constexpr double kWatch = 0.05;  // between looks at the silence of the odometry [s]

struct Setup {
  polyfly::ExcitationPlan plan;
  polyfly::ExcitationOptions options;
  bool require_engaged = true;
};

Setup readSetup(const ros::NodeHandle& private_handle) {
  Setup setup;
  ParameterReader reader(private_handle);
  setup.plan = polyfly::loadPlan(reader.requiredText("plan", "the path of a plan file"));
  polyfly::visitExcitation(setup.options, reader);
  reader("input/require_engaged", setup.require_engaged);
  reader.refuseUnknown({"vehicle", "limits", "hold", "command", "wing", "input", "output"});
  return setup;
}

std::string textOf(const polyfly::ExcitationFlight& flight) {
  std::ostringstream text;
  text << polyfly::nameOf(flight.state());
  if (flight.reason()[0] != '\0') text << ": " << flight.reason();
  if (flight.state() != polyfly::ExcitationState::kRunning) return text.str();
  if (flight.running() < 0) return text.str() + ": rest";
  const polyfly::Manoeuvre& manoeuvre = flight.plan().manoeuvres[static_cast<std::size_t>(flight.running())];
  text << ": " << polyfly::nameOf(manoeuvre.channel) << " " << polyfly::nameOf(manoeuvre.shape) << " "
       << manoeuvre.amplitude << " " << polyfly::unitOf(manoeuvre.channel) << " (" << flight.running() + 1
       << " of " << flight.plan().manoeuvres.size() << ")";
  return text.str();
}

}  // namespace

ExciteNode::ExciteNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle)
    : queue_(handle), flight_([&] {
        const Setup setup = readSetup(private_handle);
        options_ = setup.options;
        engaged_ = !setup.require_engaged;
        return polyfly::ExcitationFlight(setup.plan, setup.options);
      }()) {
  ROS_INFO_STREAM("excite:\n" << polyfly::describe(flight_.plan()));
  ros::NodeHandle nh = onQueue(handle, queue_);
  constexpr bool kLatched = true;
  if (options_.wing) {
    attitude_publisher_ = nh.advertise<mavros_msgs::AttitudeTarget>("mavros/setpoint_raw/attitude", kQueue);
  } else {
    command_publisher_ =
        nh.advertise<mav_msgs::RollPitchYawrateThrust>("command/roll_pitch_yawrate_thrust", kQueue);
  }
  reference_publisher_ = nh.advertise<geometry_msgs::PointStamped>("excitation/reference", kQueue);
  state_publisher_ = nh.advertise<std_msgs::String>("excitation/state", kQueue, kLatched);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  joy_subscriber_ = nh.subscribe("joy", kQueue, &ExciteNode::onJoy, this, hints);
  engaged_subscriber_ = nh.subscribe("engaged", kQueue, &ExciteNode::onEngaged, this, hints);
  odometry_subscriber_ = nh.subscribe(options_.wing ? "mavros/local_position/odom" : "odometry", kQueue,
                                      &ExciteNode::onOdometry, this, hints);
  timer_ = nh.createTimer(ros::Duration(kWatch), [this](const ros::TimerEvent&) { onTimer(); });
  publishState();
}

void ExciteNode::onOdometry(const nav_msgs::Odometry::ConstPtr& message) {
  if (!engaged_ || !flight_.commands()) return;
  const polyfly::VehicleState state = toVehicleState(*message);
  const polyfly::AttitudeCommand command = flight_.step(state);
  last_yaw_ = state.attitude.coeffs().allFinite() ? polyfly::eulerAngles(state.attitude).yaw : last_yaw_;
  publishCommand(command, message->header.stamp, last_yaw_);
  geometry_msgs::PointStamped reference;
  reference.header = message->header;
  reference.point.x = flight_.home().x();
  reference.point.y = flight_.home().y();
  reference.point.z = flight_.home().z();
  reference_publisher_.publish(reference);
  publishState();
}

void ExciteNode::publishCommand(const polyfly::AttitudeCommand& command, const ros::Time& stamp, double yaw) {
  if (options_.wing) {
    mavros_msgs::AttitudeTarget target;
    target.header.stamp = stamp;
    fillAttitude(command.roll, swapAngle(yaw), {command.pitch, command.thrust}, target);
    attitude_publisher_.publish(target);
    return;
  }
  mav_msgs::RollPitchYawrateThrust message;
  message.header.stamp = stamp;
  fillCommand(command, message);
  command_publisher_.publish(message);
}

void ExciteNode::onJoy(const sensor_msgs::Joy::ConstPtr& message) {
  flight_.onSticks(message->axes);
  publishState();
}

// Taking the engagement back ends all commands, like a stick.
void ExciteNode::onEngaged(const std_msgs::Bool::ConstPtr& message) {
  if (engaged_ && message->data == 0U) flight_.handOver("no longer engaged");
  engaged_ = engaged_ || message->data != 0U;
  publishState();
}

void ExciteNode::onTimer() {
  polyfly::AttitudeCommand command;
  const ros::Time now = ros::Time::now();
  if (engaged_ && flight_.onSilence(now.toSec(), &command)) publishCommand(command, now, last_yaw_);
  publishState();
}

// When something new is to be told.
void ExciteNode::publishState() {
  if (flight_.state() == told_state_ && flight_.running() == told_manoeuvre_) return;
  told_state_ = flight_.state();
  told_manoeuvre_ = flight_.running();
  std_msgs::String message;
  message.data = textOf(flight_);
  state_publisher_.publish(message);
  const bool bad = told_state_ == polyfly::ExcitationState::kAborted ||
                   told_state_ == polyfly::ExcitationState::kHandedOver;
  if (bad) ROS_WARN_STREAM("excite: " << message.data);
  if (!bad) ROS_INFO_STREAM("excite: " << message.data);
}

}  // namespace polyfly_ros
