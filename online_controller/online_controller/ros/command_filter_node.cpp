#include "online_controller_ros/command_filter_node.hpp"

#include <ros/console.h>

#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "online_controller_ros/conversions.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_ros/parameter_reader.hpp"
#include "polyfly_ros/stamps.hpp"

namespace polyfly_ros {
namespace {

using Status = online_controller::CommandFilterStatus;

constexpr int kFilterQueue = 1;
constexpr double kWarningPeriod = 1.0;  // [s]
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

static_assert(areCounted({Status::PASSED, Status::CHANGED, Status::NO_WISH, Status::OUTSIDE,
                          Status::NO_STATE}),
              "the message restates FilterStatus");

// By FilterStatus.
constexpr std::array<const char*, 5> kFilterWords{
    "passed", "changed: the nearest safe command is sent",
    "no command to filter: level attitude, hover thrust, as far as that is safe",
    "outside of the safe set: the command of least violation is sent", "no odometry to filter by"};

polyfly::AttitudeCommand toCommand(const mav_msgs::RollPitchYawrateThrust& message) {
  return {message.roll, message.pitch, message.yaw_rate, message.thrust.z};
}

void fillFilterAxis(const polyfly::FilterAxisReport& report, online_controller::CommandFilterAxis& message) {
  message.status = static_cast<std::uint8_t>(report.status);
  message.position = report.xi[0];
  message.velocity = report.xi[1];
  message.wish = report.wish;
  message.input = report.input;
}

}  // namespace

CommandFilterNode::CommandFilterNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle) try
    : queue_(handle) {
  ParameterReader reader(private_handle);
  std::vector<polyfly::RegionMap> maps;
  for (const char* axis : {"x", "y", "z"}) {
    const std::string path =
        reader.text(std::string("maps/") + axis, "the path of a map of a safety filter", "");
    if (!path.empty()) maps.push_back(polyfly::RegionMap::open(path, polyfly::kGreatestFlownMap));
  }
  polyfly::MultirotorOptions options;
  polyfly::visitOptions(options, reader);
  double silence_periods = 3.0, stale_periods = 3.0;
  reader("silence_periods", silence_periods, "samples", polyfly::Range{1.0, 100.0});
  reader("stale_periods", stale_periods, "samples", polyfly::Range{1.0, 100.0});
  for (const std::string& name : reader.unread())
    ROS_WARN("safety filter does not know the parameter %s", name.c_str());
  filter_ = std::make_unique<polyfly::CommandFilter>(std::move(maps), options);
  silence_ = silence_periods * filter_->period();
  stale_ = stale_periods * filter_->period();
  ros::NodeHandle topics = onQueue(handle, queue_);
  command_publisher_ =
      topics.advertise<mav_msgs::RollPitchYawrateThrust>("command/roll_pitch_yawrate_thrust", kFilterQueue);
  status_publisher_ = topics.advertise<Status>("filter_status", kFilterQueue);
  answer_time_ = ros::SteadyTime::now();
  const ros::TransportHints no_delay = ros::TransportHints().tcpNoDelay();
  odometry_subscriber_ =
      topics.subscribe("odometry", kFilterQueue, &CommandFilterNode::onOdometry, this, no_delay);
  wish_subscriber_ = topics.subscribe("wished/roll_pitch_yawrate_thrust", kFilterQueue,
                                      &CommandFilterNode::onWish, this, no_delay);
  timer_ = topics.createSteadyTimer(ros::WallDuration(filter_->period()),
                                    [this](const ros::SteadyTimerEvent&) { onTimer(); });
} catch (const std::exception& error) {
  ROS_FATAL("safety filter does not start: %s", error.what());
  throw;
}

void CommandFilterNode::onOdometry(const nav_msgs::Odometry& message) {
  state_ = toVehicleState(message);
  state_time_ = ros::SteadyTime::now();
}

bool CommandFilterNode::hasState() const {
  return !state_time_.isZero() && (ros::SteadyTime::now() - state_time_).toSec() <= stale_;
}

void CommandFilterNode::onWish(const mav_msgs::RollPitchYawrateThrust& message) {
  const ros::Time stamp = message.header.stamp;
  const double since = secondsBetween(answered_stamp_, stamp);
  if (answered_ && since >= 0.0 && since < polyfly::kLeastFilterPeriod * filter_->period() &&
      !stamp.isZero()) {
    ++status_.early;
    return;
  }
  answered_stamp_ = stamp;
  answered_ = true;
  answer(toCommand(message), message.header);
}

// Before the first command nothing is sent: the vehicle may stand on the ground.
void CommandFilterNode::onTimer() {
  if (!answered_ || (ros::SteadyTime::now() - answer_time_).toSec() < silence_) return;
  std_msgs::Header header;
  header.stamp = ros::Time::now();
  const ros::SteadyTime since = answer_time_;
  answer({kNotANumber, kNotANumber, kNotANumber, kNotANumber}, header);
  // The silence lasts: the next period is due at once.
  answer_time_ = since;
}

void CommandFilterNode::answer(const polyfly::AttitudeCommand& wish, const std_msgs::Header& header) {
  answer_time_ = ros::SteadyTime::now();
  const polyfly::FilterReport& result =
      hasState() ? filter_->step(state_, wish) : filter_->stepWithoutState();
  if (result.fallback != polyfly::ControlStatus::kStopped) {
    mav_msgs::RollPitchYawrateThrust command;
    command.header = header;
    fillCommand(result.command, command);
    command_publisher_.publish(command);
  }
  report(result, header);
}

void CommandFilterNode::report(const polyfly::FilterReport& report, const std_msgs::Header& header) {
  status_.header = header;
  status_.status = static_cast<std::uint8_t>(report.status);
  status_.text = kFilterWords.at(status_.status);
  if (report.status == polyfly::FilterStatus::kNoState)
    status_.text += std::string(": ") + words(report.fallback);
  fillFilterAxis(report.axes[0], status_.x);
  fillFilterAxis(report.axes[1], status_.y);
  fillFilterAxis(report.axes[2], status_.z);
  status_publisher_.publish(status_);
  ++status_.sequence;
  if (report.status >= polyfly::FilterStatus::kNoWish)
    ROS_WARN_THROTTLE(kWarningPeriod, "safety filter: %s", status_.text.c_str());
}

}  // namespace polyfly_ros
