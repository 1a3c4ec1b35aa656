#include "online_controller_ros/controller_node.hpp"

#include <ros/console.h>
#include <std_msgs/String.h>

#include <exception>
#include <limits>
#include <optional>
#include <string>

#include "online_controller/types/option_groups.hpp"
#include "online_controller_ros/conversions.hpp"
#include "online_controller_ros/flight_record.hpp"
#include "online_controller_ros/legacy_parameters.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly_ros {
namespace {

// Time between two messages that nothing is sent [s].
constexpr double kIdleInterval = 10.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

LawSetup readSetup(const ros::NodeHandle& private_handle, const LegacyNames& names) {
  ParameterReader reader(private_handle, names);
  LawSetup setup = LawSetup::read(reader);
  reader.refuseRemoved(polyfly::removedOptions());
  reader.refuseUnknown(polyfly::ownGroups());
  if (!reader.adopted().empty()) ROS_INFO("parameters of mav_control_rw: %s", reader.adopted().c_str());
  for (const std::string& name : reader.unread()) {
    const char* why = names.empty() ? nullptr : whyUnread(name);
    if (why != nullptr) ROS_WARN("parameter of mav_control_rw not read: %s: %s", name.c_str(), why);
    if (names.empty()) ROS_WARN("MPC does not know the parameter %s", name.c_str());
  }
  return setup;
}

polyfly::PilotRule pilotRule(const std::optional<bool>& demanded) {
  if (!demanded) return polyfly::PilotRule::kWhenPresent;
  return *demanded ? polyfly::PilotRule::kRequired : polyfly::PilotRule::kNotRequired;
}

}  // namespace

ControllerNode::ControllerNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                               const LegacyNames& names) try
    : ControllerNode(handle, private_handle, names, readSetup(private_handle, names)) {
} catch (const std::exception& error) {
  ROS_FATAL("MPC does not start: %s", error.what());
  throw;
}

ControllerNode::ControllerNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                               const LegacyNames& names, const LawSetup& setup)
    : handle_(onQueue(handle, queue_)),
      laws_(setup),
      watch_(laws_.laws().options().control_period,
             setup.parameters.node.stale_periods * laws_.laws().options().control_period),
      flight_(laws_.flight(), laws_.laws().options(), setup.parameters.flight,
              pilotRule(setup.parameters.use_rc_teleop)),
      record_(flight_.preview().size()),
      interface_(handle_, onQueue(private_handle, queue_), flight_, watch_.time(), setup.parameters,
                 [this](const ros::Time& now) { onManual(now); }),
      autopilot_(handle_),
      output_(handle_, setup.parameters.output, laws_.laws().options()),
      reporter_(handle_, laws_, flight_, record_, laws_.laws().options().control_period),
      law_publisher_(handle_.advertise<std_msgs::String>("active_law", 1, true)),
      law_service_(handle_.advertiseService("select_law", &ControllerNode::onSelectLaw, this)),
      odometry_(handle_.subscribe("odometry", 1, &ControllerNode::onOdometry, this,
                                  ros::TransportHints().tcpNoDelay())),
      config_thread_(handle, private_handle, setup, names, laws_, record_),
      timer_(handle_.createSteadyTimer(ros::WallDuration(watch_.interval()),
                                       [this](const ros::SteadyTimerEvent&) { onTick(); })) {
  publishLaw();
  control_thread_.start();
}

bool ControllerNode::onSelectLaw(online_controller::SelectLaw::Request& request,
                                 online_controller::SelectLaw::Response& response) {
  try {
    response.success = static_cast<unsigned char>(laws_.select(polyfly::lawOfName(request.law)));
    response.message = (response.success != 0 ? "" : request.law + " is not loaded; ") +
                       std::string(polyfly::lawName(laws_.active())) + " flies";
  } catch (const polyfly::Error& error) {
    response.success = 0;
    response.message = error.what();
  }
  publishLaw();
  return true;
}

void ControllerNode::publishLaw() {
  std_msgs::String message;
  message.data = polyfly::lawName(laws_.active());
  law_publisher_.publish(message);
}

void ControllerNode::onOdometry(const nav_msgs::Odometry& message) {
  StageClock clock;
  record_.lost += watch_.onOdometry(message.header);
  const polyfly::VehicleState state = toVehicleState(message);
  const bool frame_fits = interface_.frameFits(watch_.frame());
  StageTimes times;
  heedAutopilot();
  times.input = clock.lap();
  const polyfly::ControlReport& report = flight_.onOdometry(state, frame_fits);
  times.step = clock.lap();
  // A yaw that was refused must not reach the autopilot either: then the last one stays.
  // The heading stays as the odometry has it: the autopilot's own is taken to be that.
  const bool accepted = flight_.lastRefusal() == polyfly::ControlReason::kNone;
  if (flight_.sends()) output_.publish(report.command, message.header, accepted ? yawOf(state) : kNan);
  times.output = clock.lap();

  record(message.header, times);
  answered_.by_odometry = true;
  answered_.state = polyfly::aligned(state, laws_.laws().options().heading_misalignment);
  answered_.accepted = accepted;
  answered_.restarted = flight_.restarted();
  reportCommand();
  interface_.observe(answered_);
  swapLaws();
  laws_.flight().prepare();
  output_.prepare();
  reporter_.prepared(answered_, clock.lap());
}

void ControllerNode::record(const std_msgs::Header& header, const StageTimes& times) {
  const polyfly::ControlReport& report = flight_.report();
  answered_.header = header;
  answered_.law = laws_.flight().active();
  answered_.report = report;
  answered_.sends = flight_.sends();
  if (answered_.sends)
    record_.commands.store(report.status != polyfly::ControlStatus::kMotorsOff &&
                               report.status != polyfly::ControlStatus::kNoReference,
                           std::memory_order_relaxed);
  answered_.times = times;
  answered_.odometry_age = watch_.age();
  answered_.by_odometry = false;
}

// The command is out; this is for those who watch.
void ControllerNode::reportCommand() {
  reporter_.report(answered_);
  interface_.publishChange();
  ++answered_.sequence;
}

void ControllerNode::swapLaws() {
  if (!laws_.swap()) return;
  flight_.setLaw(laws_.flight(), laws_.laws().options());
  interface_.setObserver(laws_.laws().observer());
}

void ControllerNode::onManual(const ros::Time& now) {
  std_msgs::Header header;
  header.stamp = now;
  header.frame_id = watch_.frame();
  output_.publish(flight_.report().command, header, kNan);
  record(header, StageTimes{});
  reportCommand();
}

void ControllerNode::onTick() {
  if (!watch_.isDue()) return;
  flight_.onTime(watch_.now());
  interface_.publishChange();
  if (!watch_.hasOdometry()) swapLaws();
  if (watch_.isSilent()) onSilence();
  tellOfIdleness();
}

void ControllerNode::heedAutopilot() { flight_.onAutopilot(autopilot_.report(watch_.now())); }

// Not where the vehicle is known to rest on the ground.
void ControllerNode::tellOfIdleness() const {
  if (!watch_.hasOdometry() || flight_.sends() || flight_.state() != polyfly::FlightState::kInactive) return;
  const polyfly::AutopilotReport autopilot = autopilot_.report(watch_.now());
  const bool on_ground = autopilot.place == polyfly::AutopilotReport::Place::kOnGround;
  if (autopilot.fresh && (!autopilot.armed || on_ground)) return;
  ROS_WARN_THROTTLE(
      kIdleInterval,
      "MPC sends nothing: no reference came, and no take-off was asked for. The autopilot or the pilot "
      "has the vehicle; a receiver without a time-out keeps its last command");
}

void ControllerNode::onSilence() {
  swapLaws();  // nothing is prepared in silence
  std_msgs::Header header;
  header.stamp = watch_.stampInSilence();
  header.frame_id = watch_.frame();
  StageClock clock;
  StageTimes times;
  heedAutopilot();
  const polyfly::ControlReport& report = flight_.onSilence(header.stamp.toSec());
  times.step = clock.lap();
  if (flight_.sends()) output_.publish(report.command, header, kNan);
  times.output = clock.lap();
  record(header, times);
  reportCommand();
}

}  // namespace polyfly_ros
