#include "flight_recorder.hpp"

#include <std_msgs/Bool.h>
#include <std_msgs/String.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>

#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"
#include "read_options.hpp"

namespace polyfly_ros {
namespace {

constexpr double kRecorderPollTime = 0.02;  // wall time between looks at the publishers [s]
constexpr std::uint32_t kUnbounded = 0;
constexpr bool kLatched = true;

}  // namespace

FlightRecorder::FlightRecorder(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh) : nh_(nh) {
  std::vector<std::string> topics;
  if (!private_nh.getParam("topics", topics) || topics.empty()) {
    throw polyfly::Error(private_nh.resolveName("topics") + ": must list the topics to record");
  }
  if (!private_nh.getParam("bag", path_) || path_.empty()) {
    throw polyfly::Error(private_nh.resolveName("bag") + ": must name the bag file");
  }
  const double linger = readNumber(private_nh, "linger", 0.5, 0.0, 100.0);
  path_ = polyfly::followLinks(path_);
  using polyfly::Output;
  polyfly::checkOutputs({{path_, Output::Kind::kFile}, {path_ + ".active", Output::Kind::kFile}}, {});
  try {
    bag_->open(path_ + ".active", rosbag::bagmode::Write);
  } catch (const rosbag::BagException& error) {
    bag_.release();  // its destructor would try again to close the file, and throw
    throw polyfly::Error(path_ + ".active: cannot be written: " + error.what());
  }
  open_ = true;

  ready_pub_ = nh_.advertise<std_msgs::Bool>("recorder/ready", 1, kLatched);
  closed_pub_ = nh_.advertise<std_msgs::String>("recorder/closed", 1, kLatched);
  for (const std::string& topic : topics) {
    subscribe(topic);
  }
  // What was sent before the end may still be under way on other connections: the file stays open for a
  // moment.
  close_timer_ = nh_.createWallTimer(
      ros::WallDuration(linger), [this](const ros::WallTimerEvent&) { close(true); }, true, false);
  done_sub_ = nh_.subscribe<std_msgs::String>(
      "flight/summary", kUnbounded, [this](const std_msgs::String::ConstPtr&) { close_timer_.start(); });
  ready_timer_ = nh_.createWallTimer(ros::WallDuration(kRecorderPollTime),
                                     [this](const ros::WallTimerEvent&) { announceWhenConnected(); });
}

FlightRecorder::~FlightRecorder() { close(false); }

void FlightRecorder::subscribe(const std::string& topic) {
  ros::SubscribeOptions options;
  options.topic = topic;
  options.queue_size = kUnbounded;
  options.md5sum = ros::message_traits::md5sum<topic_tools::ShapeShifter>();
  options.datatype = ros::message_traits::datatype<topic_tools::ShapeShifter>();
  options.helper = boost::make_shared<ros::SubscriptionCallbackHelperT<const Event&>>(
      [this, name = nh_.resolveName(topic)](const Event& event) { record(name, event); });
  subscribers_.push_back(nh_.subscribe(options));
}

void FlightRecorder::record(const std::string& topic, const Event& event) {
  if (!open_) {
    return;
  }
  const ros::Time now = ros::Time::now();
  if (now.isZero()) {
    early_.emplace_back(topic, event);
    return;
  }
  writeEarly(now);
  write(topic, event, now);
}

// What came before the first /clock bears the time of the first message after it.
void FlightRecorder::writeEarly(const ros::Time& time) {
  for (const std::pair<std::string, Event>& message : early_) {
    write(message.first, message.second, time);
  }
  early_.clear();
}

void FlightRecorder::write(const std::string& topic, const Event& event, const ros::Time& time) {
  if (!open_) {
    return;
  }
  try {
    bag_->write(topic, time, *event.getMessage(), event.getConnectionHeaderPtr());
  } catch (const rosbag::BagException& error) {
    ROS_FATAL_STREAM("recorder: " << path_ << ": " << error.what());
    bag_.release();  // see the constructor
    open_ = false;
    ros::requestShutdown();
  }
}

void FlightRecorder::announceWhenConnected() {
  const bool connected =
      std::all_of(subscribers_.begin(), subscribers_.end(),
                  [](const ros::Subscriber& subscriber) { return subscriber.getNumPublishers() > 0; });
  if (!connected) {
    return;
  }
  ready_timer_.stop();
  std_msgs::Bool message;
  message.data = true;
  ready_pub_.publish(message);
}

void FlightRecorder::close(bool complete) {
  if (!open_) {
    return;
  }
  writeEarly(ros::TIME_MIN);
  // The file is no longer open when the disk filled up meanwhile.
  if (!open_) return;
  open_ = false;
  try {
    bag_->close();
  } catch (const rosbag::BagException& error) {
    bag_.release();  // see the constructor
    ROS_FATAL_STREAM("recorder: " << path_ << ": " << error.what());
    return;
  }
  if (!complete) {
    ROS_WARN_STREAM("recorder: the flight did not end; what there is of it is in " << path_ << ".active");
    return;
  }
  if (std::rename((path_ + ".active").c_str(), path_.c_str()) != 0) {
    ROS_FATAL_STREAM("recorder: cannot rename " << path_ << ".active");
    return;
  }
  ROS_INFO_STREAM("recorder: closed " << path_);
  std_msgs::String message;
  message.data = path_;
  closed_pub_.publish(message);
}

}  // namespace polyfly_ros
