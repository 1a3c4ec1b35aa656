#include "latency_probe.hpp"

#include <geometry_msgs/PoseStamped.h>
#include <nav_msgs/Odometry.h>

#include <boost/make_shared.hpp>
#include <cmath>
#include <sstream>

#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/write_file.hpp"

namespace polyfly_ros {
namespace {

constexpr double kConnectPatience = 30.0;  // [s]
constexpr double kAnswerPatience = 0.05;   // [s]

double microseconds(std::chrono::steady_clock::duration time) {
  return 1e6 * std::chrono::duration<double>(time).count();
}

}  // namespace

LatencyProbe::LatencyProbe(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle)
    : handle_(handle), turns_(private_handle.param("turn", 0.0)) {
  private_handle.param("samples", samples_, samples_);
  private_handle.param("warm_up", warm_up_, warm_up_);
  private_handle.param("rate", rate_, rate_);
  if (!private_handle.getParam("output", output_)) throw polyfly::Error("latency probe: output: missing");
  polyfly::checkOutputs({{output_}}, {});
  handle_.setCallbackQueue(&queue_);
  odometry_ = handle_.advertise<nav_msgs::Odometry>("odometry", 1);
  pose_ = handle_.advertise<geometry_msgs::PoseStamped>("command/pose", 1, true);
  subscribe();
  thread_ = std::thread([this] { run(); });
}

void LatencyProbe::subscribe() {
  ros::SubscribeOptions options;
  options.init<mav_msgs::RollPitchYawrateThrust>(
      "command/roll_pitch_yawrate_thrust", 10,
      [this](const mav_msgs::RollPitchYawrateThrust::ConstPtr& command) {
        heard_ = Clock::now();
        answered_ = command->header.stamp.toNSec();
      });
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  command_subscriber_ = handle_.subscribe(options);
  options.init<online_controller::ControllerStatus>(
      "controller_status", 10, [this](const online_controller::ControllerStatus::ConstPtr& status) {
        if (now_ == nullptr) return;
        now_->input.push_back(1e-3 * static_cast<double>(status->input_time_ns));
        now_->step.push_back(1e-3 * static_cast<double>(status->step_time_ns));
        now_->publishing.push_back(1e-3 * static_cast<double>(status->output_time_ns));
        now_->inside.push_back(now_->input.back() + now_->step.back() + now_->publishing.back());
      });
  options.callback_queue = &status_queue_;
  status_subscriber_ = handle_.subscribe(options);
}

LatencyProbe::~LatencyProbe() {
  stopping_ = true;
  thread_.join();
  command_subscriber_.shutdown();
}

void LatencyProbe::run() {
  const Clock::time_point start = Clock::now();
  while (!stopping_ && ros::ok() &&
         (odometry_.getNumSubscribers() == 0 || command_subscriber_.getNumPublishers() == 0)) {
    if (Clock::now() - start > std::chrono::duration<double>(kConnectPatience)) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  auto pose = boost::make_shared<geometry_msgs::PoseStamped>();
  pose->header.frame_id = "world";
  pose->pose.position.x = 0.3;
  pose->pose.orientation.w = 1.0;
  pose_.publish(pose);
  Clock::time_point next = Clock::now();
  for (int sample = -warm_up_; !enough() && !stopping_ && ros::ok(); ++sample) {
    next += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / rate_));
    std::this_thread::sleep_until(next);
    now_ = sample < 0 ? nullptr : timesOf(turns_.at(ros::WallTime::now().toSec()));
    exchange(sample);
    status_queue_.callAvailable();
  }
  write();
}

void LatencyProbe::exchange(int sample) {
  const auto odometry = boost::make_shared<nav_msgs::Odometry>();
  odometry->header.stamp = ros::Time::now();
  odometry->header.frame_id = "world";
  odometry->child_frame_id = "base_link";
  // Somewhere near the reference, another place each time.
  odometry->pose.pose.position.x = 0.02 * std::sin(0.05 * sample);
  odometry->twist.twist.linear.x = 0.1 * std::cos(0.05 * sample);
  odometry->pose.pose.orientation.w = 1.0;
  const std::uint64_t stamp = odometry->header.stamp.toNSec();
  const Clock::time_point sent = Clock::now();
  odometry_.publish(odometry);
  const double held = microseconds(Clock::now() - sent);
  const bool heard = waitForCommand(stamp);
  if (now_ == nullptr) return;
  if (!heard) {
    ++now_->missed;
    return;
  }
  now_->latency.push_back(microseconds(heard_ - sent));
  now_->held.push_back(held);
}

ProbeTimes* LatencyProbe::timesOf(Turns::Turn turn) {
  if (turn == Turns::Turn::kChanging) return nullptr;
  return turn == Turns::Turn::kCalm ? &calm_ : &loaded_;
}

bool LatencyProbe::enough() const {
  return calm_.count() >= samples_ && (!turns_.alternate() || loaded_.count() >= samples_);
}

bool LatencyProbe::waitForCommand(std::uint64_t stamp) {
  const Clock::time_point start = Clock::now();
  while (answered_ != stamp) {
    if (Clock::now() - start > std::chrono::duration<double>(kAnswerPatience)) return false;
    queue_.callOne(ros::WallDuration(kAnswerPatience));
  }
  return true;
}

void LatencyProbe::write() const {
  std::ostringstream text;
  text << "{\"calm\": ";
  calm_.write(text);
  text << ", \"loaded\": ";
  loaded_.write(text);
  text << "}\n";
  try {
    polyfly::writeFileAtomically(output_, text.str());
  } catch (const polyfly::Error& error) {
    ROS_FATAL_STREAM("latency probe: " << error.what());
  }
}

}  // namespace polyfly_ros
