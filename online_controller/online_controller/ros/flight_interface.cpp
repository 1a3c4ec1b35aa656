#include "online_controller_ros/flight_interface.hpp"

#include <online_controller/FlightStatus.h>
#include <online_controller/ObserverState.h>
#include <std_msgs/String.h>

#include <boost/make_shared.hpp>
#include <sstream>
#include <utility>

#include "online_controller/estimation/odometry_gate.hpp"
#include "online_controller_ros/conversions.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_ros/stamps.hpp"

namespace polyfly_ros {
namespace {

// Time between two messages about references [s].
constexpr double kLogInterval = 1.0;
// Time between two messages about velocities that contradict the positions [s].
constexpr double kTwistInterval = 5.0;
// Value of the mode axis up to which the mode is manual.
constexpr double kManualBelow = -0.5;
constexpr double kPositionFrom = 0.5;

double stick(const sensor_msgs::Joy& message, int axis, double scale) {
  if (axis < 0 || axis >= static_cast<int>(message.axes.size())) return 0.0;
  return scale * message.axes[static_cast<std::size_t>(axis)];
}

void fill(const Eigen::Vector3d& vector, boost::array<double, 3>& message) {
  for (std::size_t i = 0; i < 3; ++i) message[i] = vector(static_cast<Eigen::Index>(i));
}

/// "trajectory of 40 points; velocities of 40 and accelerations of 40 computed".
std::string summary(const polyfly::ReferenceTrajectory& trajectory) {
  const std::size_t points = trajectory.samples().size();
  if (points == 1) return "pose";
  std::string text = "trajectory of " + std::to_string(points) + " points";
  const std::size_t velocities = trajectory.computedVelocities();
  const std::size_t accelerations = trajectory.computedAccelerations();
  if (velocities + accelerations == 0) return text;
  text += "; computed:";
  if (velocities > 0) text += " velocities of " + std::to_string(velocities);
  if (velocities > 0 && accelerations > 0) text += ",";
  if (accelerations > 0) text += " accelerations of " + std::to_string(accelerations);
  return text;
}

std::string wrongFrame(const std::string& frame, const std::string& agreed) {
  return "frame '" + frame + "' is not that of the odometry, '" + agreed + "'";
}

/// What a person should know of a trajectory that begins long after `now`, or was over before; empty else.
std::string oddTime(const polyfly::ReferenceTrajectory& trajectory, double start, double now) {
  constexpr double kLongWait = 10.0;  // [s]
  const double wait = start + trajectory.startTime() - now;
  const double over = now - start - trajectory.endTime();
  if (trajectory.samples().size() < 2 || (wait <= kLongWait && over <= 0.0)) return {};
  std::ostringstream text;
  text.precision(1);
  text << std::fixed;
  if (over > 0.0) {
    text << "it was over " << over << " s ago: only its last point is left";
  } else {
    text << "it begins in " << wait << " s";
  }
  text << "; is its stamp of this clock?";
  return text.str();
}

}  // namespace

polyfly::RemoteControl toRemoteControl(const sensor_msgs::Joy& message, const polyfly::JoyLayout& layout) {
  using Mode = polyfly::RemoteControl::Mode;
  polyfly::RemoteControl sticks;
  const auto button = static_cast<std::size_t>(layout.button_on);
  sticks.on = layout.button_on < 0 || (button < message.buttons.size() && message.buttons[button] == 1);
  if (layout.axis_mode >= static_cast<int>(message.axes.size())) sticks.on = false;
  sticks.mode = Mode::kPosition;
  if (layout.axis_mode >= 0) {
    const double mode = stick(message, layout.axis_mode, 1.0);
    sticks.mode = mode <= kManualBelow   ? Mode::kManual
                  : mode < kPositionFrom ? Mode::kAltitude
                                         : Mode::kPosition;
  }
  sticks.forward = stick(message, layout.axis_forward, layout.scale_forward);
  sticks.left = stick(message, layout.axis_left, layout.scale_left);
  sticks.up = stick(message, layout.axis_up, layout.scale_up);
  sticks.turn = stick(message, layout.axis_turn, layout.scale_turn);
  return sticks;
}

FlightInterface::FlightInterface(ros::NodeHandle& handle, ros::NodeHandle private_handle,
                                 polyfly::FlightSupervisor& flight, const polyfly::TimeSource& time,
                                 const polyfly::MultirotorParameters& parameters, OnManual on_manual)
    : flight_(flight),
      time_(time),
      joy_(parameters.joy),
      observer_(parameters.nonlinear.model, parameters.controller, parameters.moments),
      frame_(parameters.odometry_frame),
      on_manual_(std::move(on_manual)),
      name_publisher_(handle.advertise<std_msgs::String>("state_machine/state_info", 1, true)),
      status_publisher_(handle.advertise<online_controller::FlightStatus>("flight_status", 1, true)) {
  ros::NodeHandle observer_handle(private_handle, "KF_observer");
  observer_publisher_ = observer_handle.advertise<online_controller::ObserverState>("observer_state", 10);
  publish();
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  trajectory_subscriber_ =
      handle.subscribe("command/trajectory", 1, &FlightInterface::onTrajectory, this, hints);
  pose_subscriber_ = handle.subscribe("command/pose", 1, &FlightInterface::onPose, this, hints);
  joy_subscriber_ = handle.subscribe("rc", 1, &FlightInterface::onJoy, this, hints);
  serve(handle, "takeoff", "take off", [this] { return flight_.takeOff(); });
  serve(handle, "back_to_position_hold", "hold its position", [this] { return flight_.holdPosition(); });
  serve(handle, "reset_integrator", "reset the integrator", [this]() -> const char* {
    flight_.resetIntegrator();
    return nullptr;
  });
  serve(handle, "reset_observer", "reset the observer", [this] { return resetObserver(); });
  serve(observer_handle, "StartCalibrateKF", "calibrate the observer", [this] { return calibrate(); });
  services_.push_back(handle.advertiseService("land", &FlightInterface::onLand, this));
}

void FlightInterface::serve(ros::NodeHandle& handle, const char* name, const char* what,
                            std::function<const char*()> request) {
  using Callback = boost::function<bool(std_srvs::Empty::Request&, std_srvs::Empty::Response&)>;
  services_.push_back(
      handle.advertiseService(name, Callback([this, what, request = std::move(request)](auto&, auto&) {
                                return answer(what, request());
                              })));
}

bool FlightInterface::frameFits(const std::string& frame) {
  if (frame_.empty() && !frame.empty()) {
    frame_ = frame;
    early_fits_ = flight_.isLocated() || early_frame_.empty() || early_frame_ == frame;
    if (!early_fits_) flight_.dropReferences();
  }
  return frame == frame_;
}

void FlightInterface::publishChange() {
  if (flight_.changes() == published_changes_) return;
  published_changes_ = flight_.changes();
  publish();
  ROS_INFO("MPC: %s: %s", polyfly::flightStateName(flight_.state()), polyfly::describe(flight_.cause()));
}

void FlightInterface::publish() {
  using Message = online_controller::FlightStatus;
  static_assert(areCounted({Message::INACTIVE, Message::TAKE_OFF, Message::POSITION_HOLD, Message::TRAJECTORY,
                            Message::REMOTE_CONTROL, Message::TELEOPERATION, Message::LANDING,
                            Message::LANDED, Message::FAILSAFE}),
                "the message restates FlightState");
  std_msgs::String name;
  name.data = polyfly::flightStateName(flight_.state());
  name_publisher_.publish(name);
  Message status;
  status.header.stamp = ros::Time::now();
  status.header.frame_id = frame_;
  status.state = static_cast<std::uint8_t>(flight_.state());
  status.name = name.data;
  status.reason = flight_.changes() == 0 ? "it has just begun" : polyfly::describe(flight_.cause());
  status.reference = reference_text_;
  status_publisher_.publish(status);
}

template <class Message>
void FlightInterface::take(const Message& message, std::optional<double> start, const char* topic) {
  std::string refusal, odd;
  const std::string& frame = message.header.frame_id;
  // Until the first odometry tells, it is that of the first reference.
  const bool early = frame_.empty() && !flight_.isLocated();
  const std::string& agreed = early ? early_frame_ : frame_;
  try {
    polyfly::ReferenceTrajectory trajectory = toReferenceTrajectory(message);
    reference_text_ = summary(trajectory);
    if (start) odd = oddTime(trajectory, *start, ros::Time::now().toSec());
    if (!frame.empty() && !agreed.empty() && frame != agreed) {
      refusal = std::string(topic) + ": " + wrongFrame(frame, agreed);
    } else if (const char* why = flight_.onReference(std::move(trajectory), start)) {
      refusal = std::string(topic) + ": " + why;
    }
  } catch (const polyfly::Error& error) {
    refusal = error.what();
  }
  if (!refusal.empty()) {
    reference_text_ = "refused: " + refusal;
    ROS_ERROR_THROTTLE(kLogInterval, "MPC keeps its reference: %s", refusal.c_str());
  } else if (!odd.empty()) {
    reference_text_ += "; " + odd;
    ROS_WARN_THROTTLE(kLogInterval, "MPC: %s: %s", topic, odd.c_str());
  } else {
    ROS_INFO_THROTTLE(kLogInterval, "MPC: %s", reference_text_.c_str());  // planners may stream
  }
  if (early && refusal.empty() && !frame.empty()) early_frame_ = frame;
  if (flight_.changes() == published_changes_) {
    publish();
  } else {
    publishChange();
  }
}

void FlightInterface::tellOfEarlyReferences() {
  if (told_of_early_ || !flight_.isLocated()) return;
  told_of_early_ = true;
  if (early_fits_ && flight_.earlyExcess().limit == nullptr) return;
  const std::string why =
      early_fits_ ? polyfly::describe(flight_.earlyExcess()) : wrongFrame(early_frame_, frame_);
  reference_text_ = "refused: " + why;
  ROS_ERROR("MPC drops the reference that came before the first odometry: %s", why.c_str());
  publish();
}

void FlightInterface::onTrajectory(const trajectory_msgs::MultiDOFJointTrajectory::ConstPtr& message) {
  take(*message, startOf(*message), "command/trajectory");
}

void FlightInterface::onPose(const geometry_msgs::PoseStamped::ConstPtr& message) {
  take(*message, std::nullopt, "command/pose");
}

void FlightInterface::onJoy(const sensor_msgs::Joy::ConstPtr& message) {
  const ros::Time now = stampOf(ros::Time::now().toSec() + time_.ahead());
  const bool command = flight_.onRemoteControl(toRemoteControl(*message, joy_), now.toSec());
  publishChange();
  if (command) on_manual_(now);
}

bool FlightInterface::answer(const char* request, const char* refusal) {
  publishChange();
  if (refusal != nullptr) ROS_WARN("MPC refuses to %s: %s", request, refusal);
  return refusal == nullptr;
}

const char* FlightInterface::resetObserver() {
  flight_.resetObserver();
  observer_.reset();
  return nullptr;
}

const char* FlightInterface::calibrate() {
  const char* refusal = flight_.hoverRefusal();
  if (refusal == nullptr) observer_.calibrate();
  return refusal;
}

void FlightInterface::observe(const Answered& answered) {
  tellOfEarlyReferences();
  if (answered.accepted) {
    if (answered.restarted) observer_.restart();
    if (answered.report.reason == polyfly::ControlReason::kContradiction) {
      ROS_WARN_THROTTLE(kTwistInterval, "MPC: %s", polyfly::kContradictionSentence);
    }
    observer_.update(answered.state, sent_);
  }
  if (answered.sends) sent_ = answered.report.command;
  const polyfly::VehicleEstimate& estimate = observer_.estimate();
  if (observer_.calibrations() != calibrations_) {
    calibrations_ = observer_.calibrations();
    flight_.setRestingDisturbance(estimate.force_offset);
    ROS_INFO("MPC: observer calibrated: force [%.3f, %.3f, %.3f] m/s^2", estimate.force_offset.x(),
             estimate.force_offset.y(), estimate.force_offset.z());
  }
  if (observer_publisher_.getNumSubscribers() == 0) return;
  const auto message = boost::make_shared<online_controller::ObserverState>();
  message->header = answered.header;
  fill(estimate.position, message->position);
  fill(estimate.velocity, message->velocity);
  fill(estimate.attitude, message->attitude);
  fill(estimate.angular_velocity, message->angular_velocity);
  fill(estimate.force, message->external_forces);
  fill(estimate.moment, message->external_moments);
  fill(estimate.force_offset, message->forces_offset);
  fill(estimate.moment_offset, message->moments_offset);
  observer_publisher_.publish(message);
}

bool FlightInterface::onLand(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
  const char* refusal = flight_.land();
  response.success = static_cast<unsigned char>(answer("land", refusal));
  response.message = refusal == nullptr ? "it lands" : refusal;
  return true;
}

}  // namespace polyfly_ros
