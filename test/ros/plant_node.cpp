#include "plant_node.hpp"

#include <geometry_msgs/Vector3Stamped.h>
#include <nav_msgs/Odometry.h>
#include <online_controller/ControllerStatus.h>
#include <online_controller/FlightStatus.h>
#include <rosgraph_msgs/Clock.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

#include "conversions.hpp"
#include "polyfly_base/error.hpp"
#include "read_options.hpp"

namespace polyfly_ros {
namespace {

using WallClock = std::chrono::steady_clock;

constexpr double kConnectionPollTime = 0.02;  // between looks at the connections before the start [s]
constexpr double kClockTimeout = 0.1;         // wall time that /clock may take inside this process [s]
constexpr double kMissedLogPeriod = 1.0;      // simulated time between complaints [s]

WallClock::duration wallSeconds(double seconds) {
  return std::chrono::duration_cast<WallClock::duration>(std::chrono::duration<double>(seconds));
}

double secondsSince(const WallClock::time_point& begin) {
  return std::chrono::duration<double>(WallClock::now() - begin).count();
}

}  // namespace

PlantNode::PlantNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh) : nh_(nh) {
  readSettings(private_nh);
  connect();
  thread_ = std::thread([this] { run(); });
}

PlantNode::~PlantNode() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void PlantNode::readSettings(const ros::NodeHandle& private_nh) {
  if (!ros::Time::isSimTime()) {
    throw polyfly::Error("/use_sim_time: must be true, since the plant owns the time");
  }
  OptionsReader plant_reader(private_nh, "vehicle");
  polyfly::visitPlantOptions(settings_.plant, plant_reader);
  plant_reader.refuseUnknown();
  polyfly::checkPlantOptions(settings_.plant);
  OptionsReader fault_reader(private_nh, "faults");
  polyfly::visitFaultOptions(settings_.faults, fault_reader);
  fault_reader.refuseUnknown();

  Settings& s = settings_;
  s.duration = readNumber(private_nh, "duration", s.duration, 0.0, 1e6);
  s.real_time_factor = readNumber(private_nh, "real_time_factor", s.real_time_factor, 0.0, 1e4);
  s.silence_real_time_factor =
      readNumber(private_nh, "silence_real_time_factor", s.silence_real_time_factor, 1e-3, 1e3);
  s.command_timeout = readNumber(private_nh, "command_timeout", s.command_timeout, 0.0, 1e4);
  s.start_timeout = readNumber(private_nh, "start_timeout", s.start_timeout, 0.0, 1e5);
  s.settle_time = readNumber(private_nh, "settle_time", s.settle_time, 0.0, 100.0);
  s.end_timeout = readNumber(private_nh, "end_timeout", s.end_timeout, 0.0, 1e4);
  s.odometry_subscribers =
      static_cast<int>(readNumber(private_nh, "odometry_subscribers", s.odometry_subscribers, 0.0, 100.0));
  s.status_lag = static_cast<int>(readNumber(private_nh, "status_lag", s.status_lag, 0.0, 1000.0));
  private_nh.param("recorder", s.recorder, s.recorder);
  private_nh.param("frame", s.frame, s.frame);
  private_nh.param("body_frame", s.body_frame, s.body_frame);
}

void PlantNode::connect() {
  // Without bounds on the queues nothing is lost however slow a subscriber is.
  constexpr std::uint32_t kUnbounded = 0;
  constexpr bool kLatched = true;
  clock_pub_ = nh_.advertise<rosgraph_msgs::Clock>("/clock", kUnbounded);
  odometry_pub_ = nh_.advertise<nav_msgs::Odometry>("odometry", kUnbounded);
  truth_pub_ = nh_.advertise<nav_msgs::Odometry>("ground_truth/odometry", kUnbounded);
  disturbance_pub_ = nh_.advertise<geometry_msgs::Vector3Stamped>("ground_truth/disturbance", kUnbounded);
  summary_pub_ = nh_.advertise<std_msgs::String>("flight/summary", kUnbounded, kLatched);

  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  command_sub_ = nh_.subscribe<mav_msgs::RollPitchYawrateThrust>(
      "command/roll_pitch_yawrate_thrust", kUnbounded,
      [this](const mav_msgs::RollPitchYawrateThrust::ConstPtr& message) {
        {
          const std::lock_guard<std::mutex> lock(mutex_);
          command_ = fromCommand(*message);
          command_stamp_ = message->header.stamp;
          has_command_ = true;
        }
        changed_.notify_all();
      },
      ros::VoidConstPtr(), hints);
  if (settings_.status_lag > 0) {
    status_sub_ = nh_.subscribe<online_controller::ControllerStatus>(
        "controller_status", kUnbounded,
        [this](const online_controller::ControllerStatus::ConstPtr& message) {
          {
            const std::lock_guard<std::mutex> lock(mutex_);
            while (!untold_.empty() && untold_.front() <= message->header.stamp) {
              untold_.pop_front();
            }
          }
          changed_.notify_all();
        },
        ros::VoidConstPtr(), hints);
    flight_status_sub_ = nh_.subscribe<online_controller::FlightStatus>(
        "flight_status", kUnbounded, [this](const online_controller::FlightStatus::ConstPtr& message) {
          const std::lock_guard<std::mutex> lock(mutex_);
          const std::string& reference = message->reference;
          controller_has_reference_ = !reference.empty() && reference.rfind("refused", 0) != 0;
        });
  }
  trajectory_sub_ = nh_.subscribe<trajectory_msgs::MultiDOFJointTrajectory>(
      "command/trajectory", kUnbounded,
      [this](const trajectory_msgs::MultiDOFJointTrajectory::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex_);
        trajectory_ = message;
      });
  if (settings_.recorder) {
    ready_sub_ =
        nh_.subscribe<std_msgs::Bool>("recorder/ready", kUnbounded, [this](const std_msgs::Bool::ConstPtr&) {
          const std::lock_guard<std::mutex> lock(mutex_);
          recorder_ready_ = true;
        });
    closed_sub_ = nh_.subscribe<std_msgs::String>("recorder/closed", kUnbounded,
                                                  [this](const std_msgs::String::ConstPtr&) {
                                                    {
                                                      const std::lock_guard<std::mutex> lock(mutex_);
                                                      recorder_closed_ = true;
                                                    }
                                                    changed_.notify_all();
                                                  });
  }
}

// Sleeps wall time, but not beyond the node's end.
void PlantNode::pause(double seconds) {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait_for(lock, wallSeconds(seconds), [this] { return stopping_; });
}

void PlantNode::run() {
  try {
    if (waitForStart()) {
      fly();
    }
  } catch (const polyfly::Error& error) {
    ROS_FATAL_STREAM("plant: " << error.what());
    ros::requestShutdown();
  }
}

// What the flight still waits for, in words; empty when nothing.
std::string PlantNode::missingForStart() {
  std::ostringstream missing;
  const auto subscribers = static_cast<int>(odometry_pub_.getNumSubscribers());
  if (subscribers < settings_.odometry_subscribers) {
    missing << "; " << subscribers << " of " << settings_.odometry_subscribers << " subscribers of "
            << odometry_pub_.getTopic();
  }
  if (command_sub_.getNumPublishers() == 0) {
    missing << "; no publisher of " << command_sub_.getTopic();
  }
  if (settings_.status_lag > 0 && status_sub_.getNumPublishers() == 0) {
    missing << "; no publisher of " << status_sub_.getTopic();
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!trajectory_) {
    missing << "; no trajectory on " << trajectory_sub_.getTopic();
  }
  // Its connection is another one: it may get the trajectory long after this node.
  if (settings_.status_lag > 0 && !controller_has_reference_) {
    missing << "; " << flight_status_sub_.getTopic() << " tells of no reference";
  }
  if (settings_.recorder && !recorder_ready_) {
    missing << "; " << ready_sub_.getTopic() << " is silent";
  }
  const std::string text = missing.str();
  return text.empty() ? text : text.substr(2);
}

bool PlantNode::waitForStart() {
  const WallClock::time_point begin = WallClock::now();
  for (std::string missing = missingForStart(); !missing.empty(); missing = missingForStart()) {
    if (secondsSince(begin) > settings_.start_timeout) {
      ROS_FATAL_STREAM("plant: no flight, after " << settings_.start_timeout
                                                  << " s there is still missing: " << missing);
      ros::requestShutdown();
      return false;
    }
    pause(kConnectionPollTime);
    const std::lock_guard<std::mutex> lock(mutex_);
    if (stopping_ || !ros::ok()) {
      return false;
    }
  }
  return true;
}

void PlantNode::fly() {
  trajectory_msgs::MultiDOFJointTrajectory::ConstPtr trajectory;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    trajectory = trajectory_;
  }
  const polyfly::PlantState start_state = startOf(*trajectory, settings_.plant.gravity);
  polyfly::MultirotorPlant plant(settings_.plant, start_state);
  start_ = trajectory->header.stamp;
  if (start_.toSec() <= settings_.plant.odometry_delay) {
    throw polyfly::Error(
        "command/trajectory: header.stamp: must be later than odometry_delay, since time starts there");
  }
  const double duration =
      settings_.duration > 0.0 ? settings_.duration : trajectory->points.back().time_from_start.toSec();
  const long samples = std::lround(duration / settings_.plant.period);
  {
    // Until the controller answers, the vehicle keeps hovering.
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!has_command_) {
      command_.thrust = settings_.plant.mass * settings_.plant.gravity;
    }
  }
  // Time begins before the first odometry, so that every node knows it by then.
  publishClock(start_);
  pause(settings_.settle_time);
  ROS_INFO_STREAM("plant: flying " << duration << " s in " << samples << " samples");

  const WallClock::time_point begin = WallClock::now();
  double wall_due = 0.0;
  for (long k = 0; k <= samples; ++k) {
    const double time = plant.time();
    const bool silent = polyfly::isSilent(settings_.faults, time);
    publishSample(plant, time);
    polyfly::AttitudeCommand command;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (stopping_) {
        return;
      }
      command = command_;
    }
    if (k < samples) {
      plant.advance(command);
    }
    const double factor = silent ? settings_.silence_real_time_factor : settings_.real_time_factor;
    const double elapsed = secondsSince(begin);
    wall_due = std::max(wall_due, elapsed - settings_.plant.period);
    if (factor > 0.0) {
      wall_due += settings_.plant.period / factor;
      if (wall_due > elapsed) {
        pause(wall_due - elapsed);
      }
    }
  }
  ROS_INFO_STREAM("plant: flew " << duration << " s in " << secondsSince(begin) << " s");
  publishSummary(plant, samples + 1);
  finish();
}

// Returns when the time has come about in this process, so that no nodelet here sees odometry before its
// time.
void PlantNode::publishClock(const ros::Time& now) {
  rosgraph_msgs::Clock clock;
  clock.clock = now;
  clock_pub_.publish(clock);
  const WallClock::time_point begin = WallClock::now();
  while (ros::Time::now() < now && secondsSince(begin) < kClockTimeout) {
    std::this_thread::yield();
  }
}

// Clock, truth and odometry of this instant; returns when it is answered.
void PlantNode::publishSample(polyfly::MultirotorPlant& plant, double time) {
  const ros::Time now = addSeconds(start_, time);
  publishClock(now);
  truth_pub_.publish(toOdometry(plant.truth(), now, settings_.frame, settings_.body_frame));
  disturbance_pub_.publish(toVector(plant.disturbance(), now, settings_.frame));

  const polyfly::VehicleState measured = polyfly::applyFaults(settings_.faults, time, plant.measure());
  if (polyfly::isSilent(settings_.faults, time)) {
    return;
  }
  const ros::Time stamp = addSeconds(start_, measured.stamp);
  if (settings_.status_lag > 0) {
    const std::lock_guard<std::mutex> lock(mutex_);
    untold_.push_back(stamp);
  }
  // A shared pointer, so that a nodelet in the same process gets the message without a copy.
  odometry_pub_.publish(boost::make_shared<nav_msgs::Odometry>(
      toOdometry(measured, stamp, settings_.frame, settings_.body_frame)));
  waitForAnswer(stamp);
}

// A controller tells of its commands when they are out; no more of them wait for that than it can hold.
void PlantNode::waitForAnswer(const ros::Time& stamp) {
  std::unique_lock<std::mutex> lock(mutex_);
  const auto most_untold = static_cast<std::size_t>(settings_.status_lag);
  const auto commanded = [this, &stamp] { return has_command_ && command_stamp_ == stamp; };
  const bool answered = changed_.wait_for(lock, wallSeconds(settings_.command_timeout), [&] {
    return stopping_ || (commanded() && untold_.size() <= most_untold);
  });
  if (answered) {
    return;
  }
  if (commanded()) {
    ROS_WARN_STREAM("plant: no status for the odometry of " << untold_.front() << " after "
                                                            << settings_.command_timeout << " s");
    untold_.clear();
  } else {
    ++missed_commands_;
    ROS_WARN_STREAM_THROTTLE(kMissedLogPeriod, "plant: no command for the odometry of "
                                                   << stamp << " after " << settings_.command_timeout
                                                   << " s; the last one stays (" << missed_commands_
                                                   << " missed)");
  }
}

void PlantNode::publishSummary(const polyfly::MultirotorPlant& plant, long samples) {
  std::ostringstream text;
  text << "{\"samples\": " << samples << ", \"missed_commands\": " << missed_commands_
       << ", \"cut_commands\": " << plant.saturatedCommands()
       << ", \"ignored_commands\": " << plant.ignoredCommands() << "}";
  ROS_INFO_STREAM("plant: " << text.str());
  std_msgs::String message;
  message.data = text.str();
  summary_pub_.publish(message);
}

// Leaves the recorder time to close its file.
void PlantNode::finish() {
  if (!settings_.recorder) {
    pause(settings_.settle_time);
    return;
  }
  std::unique_lock<std::mutex> lock(mutex_);
  const bool closed = changed_.wait_for(lock, wallSeconds(settings_.end_timeout),
                                        [this] { return stopping_ || recorder_closed_; });
  if (!closed) {
    ROS_ERROR_STREAM("plant: " << closed_sub_.getTopic() << " is silent after " << settings_.end_timeout
                               << " s");
  }
}

}  // namespace polyfly_ros
