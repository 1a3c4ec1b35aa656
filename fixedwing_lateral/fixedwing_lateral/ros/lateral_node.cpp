#include "fixedwing_lateral_ros/lateral_node.hpp"

#include <algorithm>
#include <boost/make_shared.hpp>
#include <chrono>
#include <exception>

#include "polyfly_base/error.hpp"
#include "polyfly_ros/parameter_reader.hpp"
#include "polyfly_ros/stamps.hpp"

namespace polyfly_ros {
namespace {

constexpr std::uint32_t kQueue = 10;
constexpr double kLogInterval = 1.0;  // between two warnings [s]
constexpr double kEarly = 0.25;       // share of the period by which odometry may come before its step is due
constexpr double kLate = 0.5;         // share of the period after which a step is made without new odometry

constexpr double kRateTimeout = 0.2;  // greatest age of an angular rate; after it the odometry's is used [s]

/// Parameters that were removed, and what to use instead.
std::vector<polyfly::RemovedOption> removedParameters() {
  std::vector<polyfly::RemovedOption> removed = {
      {"guidance/turn_gain", "the gain is learnt within a minute"},
      {"guidance/delay", "model/a1 of 'calibrate apply' includes the delay"},
      {"output/stream_in_standby", "input/watch_autopilot streams the present roll in standby"}};
  for (const char* name : {"weights/feedforward", "weights/curvature", "path/smooth_radius",
                           "path/switch_at_bisector", "path/choose_side", "guidance/wind_correction_time",
                           "guidance/learn_disturbance", "safety/convergence_turns"})
    removed.push_back({name, "guidance/as_published: true takes off all additions"});
  for (const char* name :
       {"model/gravity", "model/switch_rate", "model/switch_threshold", "limits/roll_penalty",
        "path/course_tolerance", "path/turn_share", "path/turn_deviation", "guidance/time_budget",
        "guidance/iterations", "guidance/kkt_tolerance", "guidance/applied_move", "safety/hysteresis",
        "safety/jump_patience", "safety/upwind_gain", "safety/convergence_time", "input/autopilot_timeout",
        "input/imu_timeout"})
    removed.push_back({name, "it has a fixed value, so leave it out"});
  return removed;
}

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Steady [s].
double wallTime() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

OptionTable tableOf(polyfly::GuidanceOptions& options) {
  OptionTable table({}, '_');
  polyfly::visitTuning(options.weights, table);
  polyfly::visitLimits(options.limits, table);
  polyfly::visitSafety(options.safety, table);
  return table;
}

}  // namespace

LateralNode::Setup LateralNode::readSetup(const ros::NodeHandle& private_handle) {
  Setup setup;
  ParameterReader reader(private_handle);
  polyfly::visitLateralParameters(setup, reader);
  reader.refuseRemoved(removedParameters());
  reader.refuseUnknown({polyfly::kLateralGroups.begin(), polyfly::kLateralGroups.end()});
  polyfly::finishParameters(&setup, private_handle.getNamespace());
  return setup;
}

LateralNode::LateralNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle) try
    : LateralNode(handle, private_handle, readSetup(private_handle)) {
} catch (const std::exception& error) {
  ROS_FATAL("lateral guidance does not start: %s", error.what());
  throw;
}

LateralNode::LateralNode(ros::NodeHandle handle, ros::NodeHandle private_handle, const Setup& setup)
    : queue_(handle),
      setup_(setup),
      table_(tableOf(setup_.guidance)),
      bounds_(table_.bounds()),
      reconfigure_(onQueue(private_handle, queue_), table_, [this] { onReconfigure(); }),
      guidance_(setup.guidance, private_handle.getNamespace()),
      in_force_(onQueue(private_handle, queue_), "fixed_wing",
                [this](polyfly::OptionsText& text) { writeInForce(text); }),
      diagnostics_(handle, private_handle, private_handle.getNamespace()),
      autopilot_(setup.engaged_modes, private_handle.getNamespace() + "/input/engaged_modes"),
      engaged_(!setup.require_engaged),
      time_(ros::Time::isSimTime()) {
  shown_.reason = polyfly::GuidanceReason::kNone;
  diagnostics_.setHardwareID("none");
  diagnostics_.add("lateral guidance", this, &LateralNode::diagnose);
  ros::NodeHandle topics = onQueue(handle, queue_);
  connect(topics);
}

void LateralNode::connect(ros::NodeHandle& handle) {
  twist_publisher_ =
      handle.advertise<geometry_msgs::TwistStamped>("mavros/setpoint_attitude/cmd_vel", kQueue);
  if (setup_.publish_attitude)
    attitude_publisher_ =
        handle.advertise<mavros_msgs::AttitudeTarget>("mavros/setpoint_raw/attitude", kQueue);
  status_publisher_ = handle.advertise<fixedwing_lateral::LateralStatus>("lateral_status", 100);
  marker_publisher_ = handle.advertise<visualization_msgs::MarkerArray>("lateral_markers", 1);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  mission_subscriber_ = handle.subscribe("mission", 1, &LateralNode::onMission, this, hints);
  if (setup_.watch_autopilot)
    autopilot_subscriber_ = handle.subscribe("mavros/state", 1, &LateralNode::onAutopilot, this, hints);
  engaged_subscriber_ = handle.subscribe("engaged", 1, &LateralNode::onEngaged, this, hints);
  imu_subscriber_ = handle.subscribe("mavros/imu/data", 1, &LateralNode::onImu, this, hints);
  hud_subscriber_ = handle.subscribe("mavros/vfr_hud", 1, &LateralNode::onHud, this, hints);
  wind_subscriber_ = handle.subscribe("mavros/wind_estimation", 1, &LateralNode::onWind, this, hints);
  odometry_subscriber_ =
      handle.subscribe("mavros/local_position/odom", 1, &LateralNode::onOdometry, this, hints);
  timer_ = handle.createTimer(ros::Duration(0.5 * setup_.guidance.period),
                              [this](const ros::TimerEvent&) { onTimer(); });
  if (!ros::Time::isSimTime()) return;
  wall_timer_ = handle.createSteadyTimer(ros::WallDuration(0.5 * setup_.guidance.period),
                                         [this](const ros::SteadyTimerEvent&) { onTimer(); });
}

// The table holds the new values, each within its range; where this throws, the server puts the old ones back.
void LateralNode::onReconfigure() {
  const double now = wallTime();
  polyfly::checkGuidance(setup_.guidance, "reconfigure");
  if (commands_) {
    bounds_.check(table_.values(), now);
    bounds_.change(table_.values(), now);
  } else {
    bounds_.settle(table_.values());
  }
  guidance_.setTuning(setup_.guidance.weights, setup_.guidance.limits, setup_.guidance.safety);
  in_force_.hasChanged("reconfigure");
}

void LateralNode::writeInForce(polyfly::OptionsText& text) const {
  text.text(std::string(polyfly::kInForceGroup) + "/law", "lateral_nmpc");
  polyfly::visitLateralParameters(setup_, text);
}

// A step is due at a fixed rate, and made as soon as the state of that period is in.
void LateralNode::onOdometry(const nav_msgs::Odometry::ConstPtr& message) {
  time_.onOdometry(ros::Time::now().toSec(), wallTime(), message->header.stamp.toSec());
  const double now = time_.arrival();
  const bool first = !has_odometry_;
  has_odometry_ = true;
  odometry_header_ = message->header;
  if (first) checkEarlyMission();
  altitude_ = message->pose.pose.position.z;
  input_.state = toAircraftState(*message);
  const bool has_rate = std::abs(secondsBetween(imu_stamp_, message->header.stamp)) <= kRateTimeout;
  if (has_rate) input_.state.roll_rate = imu_rate_;
  const double period = setup_.guidance.period;
  if (next_ - now > 2.0 * period) next_ = now;  // simulated time began anew
  if (now >= next_ - kEarly * period) step(now);
}

void LateralNode::onTimer() {
  double now = ros::Time::now().toSec();
  time_.advance(now, wallTime());
  tellOfClock();
  // Where the clock is dead, time goes on by wall time, and goes on from there when it runs again.
  if (ros::Time::isSimTime()) now = time_.arrival() + time_.silence();
  if (has_odometry_ && now > next_ + kLate * setup_.guidance.period) {
    ++late_steps_;
    step(now);
  }
  diagnostics_.update();
  reconfigure_.publish();
  in_force_.publish();
  reconfigure_.writeParameters();
}

void LateralNode::tellOfClock() {
  if (time_.byWall() == told_of_wall_time_) return;
  told_of_wall_time_ = time_.byWall();
  ROS_WARN("lateral guidance: %s", told_of_wall_time_
                                       ? "odometry comes, but simulated time stands still: wall time decides "
                                         "when odometry is silent. Does anybody publish /clock?"
                                       : "simulated time runs again, and decides when odometry is silent");
}

// Without a name it is that of the odometry.
void LateralNode::requireFrame(const std::string& frame) const {
  const std::string& agreed = odometry_header_.frame_id;
  if (frame.empty() || agreed.empty() || frame == agreed) return;
  throw polyfly::Error("mission: frame '" + frame + "' is not that of the odometry, '" + agreed + "'");
}

void LateralNode::checkEarlyMission() {
  try {
    requireFrame(mission_frame_);
  } catch (const polyfly::Error& error) {
    guidance_.clearMission();
    ROS_ERROR("lateral guidance drops the mission that came before the first odometry: %s", error.what());
  }
}

void LateralNode::onImu(const sensor_msgs::Imu::ConstPtr& message) {
  imu_rate_ = message->angular_velocity.x;
  imu_stamp_ = message->header.stamp;
}

void LateralNode::onHud(const mavros_msgs::VFR_HUD::ConstPtr& message) {
  input_.airspeed = {static_cast<double>(message->airspeed), message->header.stamp.toSec()};
}

void LateralNode::onWind(const geometry_msgs::TwistWithCovarianceStamped::ConstPtr& message) {
  input_.wind = toWind(*message);
}

void LateralNode::onMission(const fixedwing_lateral::Mission::ConstPtr& message) {
  try {
    if (isEmpty(*message)) {
      guidance_.clearMission();
      mission_frame_.clear();
      ROS_INFO("lateral guidance: the mission is ended");
      return;
    }
    requireFrame(message->header.frame_id);
    const polyfly::TurnPlan turns = polyfly::turnPlanOf(setup_, guidance_.output());
    polyfly::Mission mission = toMission(*message, setup_.guidance.loiter, turns);
    if (mission.merged_points > 0)
      ROS_WARN("lateral guidance: %d way-points less than %.1f m from the one before are left out",
               mission.merged_points, polyfly::kSamePoint);
    guidance_.setMission(std::move(mission));
    mission_frame_ = message->header.frame_id;
    ROS_INFO("lateral guidance: a mission of %d segments", guidance_.track().count());
    const std::string steep = describeSteep(guidance_.track().segments(), turns.conditions);
    if (!steep.empty()) ROS_WARN("lateral guidance: %s; it may be left there", steep.c_str());
  } catch (const polyfly::Error& error) {
    ROS_ERROR("lateral guidance keeps its mission: %s", error.what());
  }
}

void LateralNode::onEngaged(const std_msgs::Bool::ConstPtr& message) { engaged_ = message->data; }

void LateralNode::onAutopilot(const mavros_msgs::State::ConstPtr& message) { autopilot_.take(*message); }

void LateralNode::step(double now) {
  const double period = setup_.guidance.period;
  input_.time = now;
  next_ = std::max(next_, input_.time - period) + period;  // a missed step is not made up for
  input_.engaged = engaged_ && (!setup_.watch_autopilot || autopilot_.follows(input_.time));
  const Clock::time_point start = Clock::now();
  const polyfly::GuidanceOutput& output = guidance_.update(input_);
  feedback_time_ = secondsSince(start);
  publishCommand(output, odometry_header_);
  publishStatus(output, odometry_header_);
  logChange(output);
  ++steps_;
  const Clock::time_point published = Clock::now();
  guidance_.prepare();
  preparation_time_ = secondsSince(published);
}

void LateralNode::publishCommand(const polyfly::GuidanceOutput& output, const std_msgs::Header& header) {
  // Nothing that the autopilot might take for a command while it does not follow; but some autopilots begin
  // to follow only where set-points come in already, and get the roll that is flown.
  if (output.mode == polyfly::GuidanceMode::kStandby && !setup_.watch_autopilot) return;
  const auto twist = boost::make_shared<geometry_msgs::TwistStamped>();
  twist->header = header;
  fillTwist(output.roll_reference, *twist);
  twist_publisher_.publish(twist);
  commands_ = true;
  if (!setup_.publish_attitude || !std::isfinite(input_.state.heading)) return;
  const auto attitude = boost::make_shared<mavros_msgs::AttitudeTarget>();
  attitude->header = header;
  fillAttitude(output.roll_reference, input_.state.heading, setup_.attitude, *attitude);
  attitude_publisher_.publish(attitude);
}

void LateralNode::publishStatus(const polyfly::GuidanceOutput& output, const std_msgs::Header& header) {
  const auto status = boost::make_shared<fixedwing_lateral::LateralStatus>();
  status->header = header;
  fillStatus(output, *status);
  status->state_age = input_.time - header.stamp.toSec();
  status->feedback_time = feedback_time_;
  status->preparation_time = preparation_time_;
  status_publisher_.publish(status);
  if (marker_publisher_.getNumSubscribers() == 0) return;
  const auto markers = boost::make_shared<visualization_msgs::MarkerArray>();
  fillMarkers(guidance_, header, altitude_, *markers);
  marker_publisher_.publish(markers);
}

void LateralNode::diagnose(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  // L1 guidance flies the mission too, but something is wrong.
  const bool is_well =
      shown_.mode == polyfly::GuidanceMode::kTracking || shown_.mode == polyfly::GuidanceMode::kFallback;
  const bool is_nominal = shown_.reason == polyfly::GuidanceReason::kNone;
  if (!has_odometry_) {
    status.summary(DiagnosticStatus::ERROR, "no odometry yet");
  } else {
    status.summary(is_well && is_nominal ? DiagnosticStatus::OK
                   : is_well             ? DiagnosticStatus::WARN
                                         : DiagnosticStatus::ERROR,
                   std::string(toString(shown_.mode)) + ": " + toString(shown_.reason));
  }
  if (setup_.watch_autopilot) status.add("autopilot", autopilot_.text(input_.time));
  status.add("steps", steps_);
  status.add("steps without new odometry", late_steps_);
  status.add("feedback [us]", 1e6 * feedback_time_);
  status.add("preparation [us]", 1e6 * preparation_time_);
  status.add("segment", shown_.segment);
  status.add("track error [m]", shown_.error.track);
  status.add("roll that the segment asks for [rad]", shown_.segment_roll);
}

void LateralNode::logChange(const polyfly::GuidanceOutput& output) {
  const bool changed = output.mode != shown_.mode || output.reason != shown_.reason;
  shown_ = output;
  if (!changed) return;
  if (output.mode == polyfly::GuidanceMode::kTracking && output.reason == polyfly::GuidanceReason::kNone) {
    ROS_INFO_THROTTLE(kLogInterval, "lateral guidance: tracking");
  } else {
    ROS_WARN_THROTTLE(kLogInterval, "lateral guidance: %s: %s", toString(output.mode),
                      toString(output.reason));
  }
}

}  // namespace polyfly_ros
