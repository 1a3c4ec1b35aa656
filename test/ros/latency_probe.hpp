#pragma once

#include <mav_msgs/RollPitchYawrateThrust.h>
#include <online_controller/ControllerStatus.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>

#include "probe_times.hpp"

namespace polyfly_ros {

/// Measures how long a controller takes from odometry to command. Publishes odometry at a fixed rate of wall time
/// from a thread of its own, and waits for the command with the same stamp. Leaves its figures as JSON in the file
/// `output`. Parameters: test/README.md.
class LatencyProbe {
 public:
  LatencyProbe(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle);
  ~LatencyProbe();

 private:
  using Clock = std::chrono::steady_clock;

  void subscribe();
  void run();
  bool waitForCommand(std::uint64_t stamp);
  void exchange(int sample);
  ProbeTimes* timesOf(Turns::Turn turn);
  bool enough() const;
  void write() const;

  // Queue of the commands. It outlives what is served on it.
  ros::CallbackQueue queue_;
  ros::CallbackQueue status_queue_;
  ros::NodeHandle handle_;
  int samples_ = 1000;
  int warm_up_ = 100;
  double rate_ = 100.0;  // [1/s]
  std::string output_;

  ros::Publisher odometry_;
  ros::Publisher pose_;
  ros::Subscriber command_subscriber_;
  ros::Subscriber status_subscriber_;
  // Time at which the last command came.
  Clock::time_point heard_;
  // Stamp of the last command [ns].
  std::uint64_t answered_ = 0;
  Turns turns_;
  ProbeTimes calm_, loaded_;
  // Times that the measured values belong to: calm_ or loaded_. It is nullptr while a turn begins.
  ProbeTimes* now_ = nullptr;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace polyfly_ros
