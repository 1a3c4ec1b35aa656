#include "online_controller_ros/controller_node.hpp"

#include <std_msgs/String.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <chrono>
#include <exception>

#include "online_controller_ros/conversions.hpp"
#include "region_maps/error.hpp"

namespace polyfly_ros {
namespace {

constexpr std::uint32_t kCommandQueue = 10;  // a recorder over TCP may lag behind for a moment
constexpr double kLogInterval = 1.0;         // between two warnings [s]

using Clock = std::chrono::steady_clock;

std::int64_t nanosecondsSince(Clock::time_point start) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - start).count();
}

}  // namespace

ExplicitMpcNode::Setup ExplicitMpcNode::readSetup(const ros::NodeHandle& private_handle) {
  Setup setup;
  ParameterReader reader(private_handle);
  setup.laws = LawSetup::read(reader);
  setup.flight = FlightSetup::read(reader);
  visitNodeOptions(setup.node, reader);
  reader.refuseUnknown(
      {"maps", "robust_maps", "problems", "vehicle", "controller", "nonlinear", "control_interface", "rc"});
  return setup;
}

ExplicitMpcNode::ExplicitMpcNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle) try
    : ExplicitMpcNode(handle, readSetup(private_handle)) {
} catch (const std::exception& error) {
  ROS_FATAL("explicit MPC does not start: %s", error.what());
  throw;
}

ExplicitMpcNode::ExplicitMpcNode(ros::NodeHandle handle, const Setup& setup)
    : laws_(setup.laws),
      controller_(laws_.flight()),
      flight_(controller_, setup.laws.controller, setup.flight.flight, setup.flight.pilot),
      interface_(handle, flight_, setup.flight),
      control_period_(setup.laws.controller.control_period),
      silence_(setup.node.stale_periods * control_period_) {
  connect(handle);
}

void ExplicitMpcNode::connect(ros::NodeHandle& handle) {
  command_publisher_ =
      handle.advertise<mav_msgs::RollPitchYawrateThrust>("command/roll_pitch_yawrate_thrust", kCommandQueue);
  status_publisher_ = handle.advertise<online_controller::ControllerStatus>("controller_status", 100);
  law_publisher_ = handle.advertise<std_msgs::String>("active_law", 1, true);
  publishLaw();
  law_service_ = handle.advertiseService("select_law", &ExplicitMpcNode::onSelectLaw, this);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  interface_.onManual([this](const ros::Time& now) { onManual(now); });
  odometry_subscriber_ = handle.subscribe("odometry", 1, &ExplicitMpcNode::onOdometry, this, hints);
  watchdog_ =
      handle.createTimer(ros::Duration(control_period_), [this](const ros::TimerEvent&) { onWatchdog(); });
}

void ExplicitMpcNode::onOdometry(const nav_msgs::Odometry::ConstPtr& message) {
  arrival_ = ros::Time::now();
  // /clock is handled on another thread: simulated time may still stand before the odometry that came with it
  if (ros::Time::isSimTime()) arrival_ = std::max(arrival_, message->header.stamp);
  has_odometry_ = true;
  frame_ = message->header.frame_id;
  odometry_age_ = (arrival_ - message->header.stamp).toSec();
  const polyfly::VehicleState state = toVehicleState(*message);
  const bool frame_fits = interface_.frameFits(frame_);

  const Clock::time_point start = Clock::now();
  const polyfly::ControlReport& report = flight_.onOdometry(state, frame_fits);
  const std::int64_t step_time_ns = nanosecondsSince(start);
  publish(report, message->header, step_time_ns);
  controller_.prepare();
}

bool ExplicitMpcNode::onSelectLaw(online_controller::SelectLaw::Request& request,
                                  online_controller::SelectLaw::Response& response) {
  try {
    response.success = static_cast<unsigned char>(controller_.select(polyfly::lawOfName(request.law)));
    response.message = (response.success != 0 ? "" : request.law + " is not loaded; ") +
                       std::string(polyfly::lawName(controller_.active())) + " flies";
  } catch (const polyfly::Error& error) {
    response.success = 0;
    response.message = error.what();
  }
  publishLaw();
  return true;
}

void ExplicitMpcNode::publishLaw() {
  std_msgs::String message;
  message.data = polyfly::lawName(controller_.active());
  law_publisher_.publish(message);
}

void ExplicitMpcNode::onManual(const ros::Time& now) {
  std_msgs::Header header;
  header.stamp = now;
  header.frame_id = frame_;
  publish(flight_.report(), header, 0);
}

void ExplicitMpcNode::onWatchdog() {
  const ros::Time now = ros::Time::now();
  flight_.onTime(now.toSec());
  interface_.publishChange();
  if (!has_odometry_) return;
  if (now < arrival_) arrival_ = now;  // simulated time began anew
  if (now - arrival_ <= silence_) return;
  const Clock::time_point start = Clock::now();
  const polyfly::ControlReport& report = flight_.onSilence(now.toSec());
  const std::int64_t step_time_ns = nanosecondsSince(start);
  std_msgs::Header header;
  header.stamp = now;
  header.frame_id = frame_;
  odometry_age_ = (now - arrival_).toSec();
  publish(report, header, step_time_ns);
}

void ExplicitMpcNode::publish(const polyfly::ControlReport& report, const std_msgs::Header& header,
                              std::int64_t step_time_ns) {
  // A fresh message each time: neighbours in the same nodelet manager share it, so it must not change
  // afterwards.
  if (flight_.sends()) {
    const auto command = boost::make_shared<mav_msgs::RollPitchYawrateThrust>();
    command->header = header;
    fillCommand(report.command, *command);
    command_publisher_.publish(command);
  }

  const auto status = boost::make_shared<online_controller::ControllerStatus>();
  status->header = header;
  status->sequence = sequence_++;
  status->odometry_age = odometry_age_;
  status->step_time_ns = step_time_ns;
  status->lookup_time_ns = lookupTime(report);
  fillStatus(report, laws_.parameters(controller_.active()), *status);
  status_publisher_.publish(status);
  interface_.publishChange();
  logChange(report);
}

std::int64_t ExplicitMpcNode::lookupTime(const polyfly::ControlReport& report) const {
  const std::vector<polyfly::RegionMap>& maps = laws_.maps(controller_.active());
  if (maps.empty()) return 0;
  for (const polyfly::AxisReport& axis : report.axis) {
    if (axis.size == 0) return 0;
  }
  double input = 0.0;
  const Clock::time_point start = Clock::now();
  for (std::size_t i = 0; i < maps.size(); ++i) maps[i].evaluate(report.axis[i].theta.data(), &input);
  return nanosecondsSince(start) / static_cast<std::int64_t>(maps.size());
}

void ExplicitMpcNode::logChange(const polyfly::ControlReport& report) {
  if (report.status == logged_status_ && report.reason == logged_reason_) return;
  logged_status_ = report.status;
  logged_reason_ = report.reason;
  const std::string text = describe(report, laws_.parameters(controller_.active()));
  if (report.status == polyfly::ControlStatus::kOptimal) {
    ROS_INFO_THROTTLE(kLogInterval, "explicit MPC: %s", text.c_str());
  } else {
    ROS_WARN_THROTTLE(kLogInterval, "explicit MPC: %s", text.c_str());
  }
}

}  // namespace polyfly_ros
