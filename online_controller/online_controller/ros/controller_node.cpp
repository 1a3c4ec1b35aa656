#include "online_controller_ros/controller_node.hpp"

#include <ros/console.h>

#include <exception>
#include <limits>
#include <string>

#include "online_controller/types/option_groups.hpp"
#include "online_controller_ros/conversions.hpp"
#include "online_controller_ros/stage_clock.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly_ros {
namespace {

// Time between two messages that nothing is sent [s].
constexpr double kIdleInterval = 10.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Parameters of earlier versions. A launch file that still sets them flies as without them.
constexpr const char* kRemoved[] = {"real_time/poll", "real_time/rehearse"};

/// Parameters of earlier versions that a flight would miss, and what to use instead.
constexpr struct {
  const char* name;
  const char* instead;
} kRefused[] = {{"control_interface/idle_publishes",
                 "nothing is sent before a reference or a take-off; for the set-points that an autopilot "
                 "needs to become guided use "
                 "control_interface/offboard_stream"}};

}  // namespace

ControllerNode::Setup ControllerNode::readSetup(const ros::NodeHandle& private_handle,
                                                bool has_legacy_names) {
  Setup setup;
  ParameterReader reader(private_handle);
  setup.laws = LawSetup::read(reader);
  setup.flight = FlightSetup::read(reader);
  visitNodeOptions(setup.node, reader);
  setup.output = readOutputOptions(reader);
  visitRealTimeOptions(setup.real_time, reader);
  setup.answer = reader.text("real_time/answer", "auto, publisher or thread", "auto");
  setup.in_publisher = answersInPublisher(setup.answer, setup.real_time);
  reader("provenance", setup.provenance);
  reader.passOver(polyfly::kInForceGroup);
  for (const auto& refused : kRefused) {
    if (reader.given(refused.name))
      throw polyfly::Error(std::string("parameter ") + refused.name + " is removed: " + refused.instead);
  }
  for (const char* name : kRemoved) {
    if (reader.given(name)) ROS_WARN("MPC does not use the parameter %s any more; it is ignored", name);
  }
  reader.refuseUnknown(polyfly::ownGroups());
  if (!has_legacy_names) {  // else the import has told
    for (const std::string& name : reader.unread())
      ROS_WARN("MPC does not know the parameter %s", name.c_str());
  }
  return setup;
}

polyfly::MultirotorParameters ControllerNode::Setup::parameters() const {
  polyfly::MultirotorParameters all;
  all.odometry_frame = flight.odometry_frame;
  if (flight.pilot != polyfly::PilotRule::kWhenPresent)
    all.use_rc_teleop = flight.pilot == polyfly::PilotRule::kRequired;
  all.provenance = provenance;
  all.answer = answer;
  all.flight = flight.flight;
  all.node = node;
  all.joy = flight.joy;
  all.output = output;
  all.real_time = real_time;
  return all;
}

ControllerNode::ControllerNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                               const LegacyNames& names, ProcessKind process) try
    : ControllerNode(handle, private_handle, names, process, readSetup(private_handle, !names.empty())) {
} catch (const std::exception& error) {
  ROS_FATAL("MPC does not start: %s", error.what());
  throw;
}

ControllerNode::ControllerNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                               const LegacyNames& names, ProcessKind process, const Setup& setup)
    : handle_(onQueue(handle, queue_)),
      laws_(setup.laws),
      watch_(setup.laws.controller.control_period,
             setup.node.stale_periods * setup.laws.controller.control_period),
      flight_(laws_.flight(), setup.laws.controller, setup.flight.flight, setup.flight.pilot),
      record_(flight_.preview().size()),
      interface_(handle_, onQueue(private_handle, queue_), flight_, watch_.time(), setup.flight, setup.laws,
                 [this](const ros::Time& now) { onManual(now); }),
      autopilot_(handle_),
      output_(handle_, setup.output, setup.laws.controller),
      reporter_(handle_, laws_, flight_, record_, setup.laws.controller.control_period),
      law_selector_(handle_, laws_, [this] { finish(); }),
      odometry_(handle_, setup.in_publisher, process,
                {[this](const nav_msgs::Odometry& message) { onOdometry(message); }, [this] { finish(); }},
                lock_, queue_, record_),
      config_thread_(handle, private_handle, {setup.laws, setup.parameters(), names}, laws_, record_),
      control_thread_(queue_, "mpc_control",
                      {[real_time = setup.real_time] {
                         const std::string refused = becomeRealTime(real_time);
                         if (!refused.empty()) ROS_WARN("MPC: %s", refused.c_str());
                       },
                       [this] { onTick(); }, watch_.interval(), &lock_}) {}

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

  Answered& answered = record(message.header, times);
  answered.by_odometry = true;
  answered.state = polyfly::aligned(state, laws_.laws().options().heading_misalignment);
  answered.accepted = accepted;
  answered.restarted = flight_.restarted();
}

Answered& ControllerNode::record(const std_msgs::Header& header, const StageTimes& times) {
  const polyfly::ControlReport& report = flight_.report();
  Answered& answered = answered_.add();
  answered.header = header;
  answered.law = laws_.flight().active();
  answered.report = report;
  answered.sends = flight_.sends();
  if (answered.sends)
    record_.commands.store(report.status != polyfly::ControlStatus::kMotorsOff &&
                               report.status != polyfly::ControlStatus::kNoReference,
                           std::memory_order_relaxed);
  answered.times = times;
  answered.odometry_age = watch_.age();
  answered.by_odometry = false;
  return answered;
}

// In the control thread. The command is out; this is for the next one, and for those who watch.
void ControllerNode::finish() {
  if (answered_.empty()) return;
  StageClock clock;
  const Answered& last = answered_.last();
  for (const Answered& answered : answered_) {
    reporter_.report(answered, &answered == &last);
    if (answered.by_odometry) interface_.observe(answered);
  }
  interface_.publishChange();
  if (last.by_odometry) {
    swapLaws();
    laws_.flight().prepare();
    output_.prepare();
    reporter_.prepared(last, clock.lap());
  }
  answered_.clear();
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
  finish();
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
  finish();
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
  finish();
}

}  // namespace polyfly_ros
