#pragma once

#include <mav_msgs/RollPitchYawrateThrust.h>
#include <online_controller/ControllerStatus.h>
#include <ros/ros.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "online_controller_ros/callback_thread.hpp"

namespace polyfly_ros {

/// Measures how long a controller takes from odometry to command: publishes odometry at a fixed rate of wall
/// time from a thread of its own and waits in it for the command with the same stamp. Leaves its figures as
/// JSON in the file `output`. Parameters: test/README.md.
class LatencyProbe {
 public:
  LatencyProbe(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle);
  ~LatencyProbe();

 private:
  using Clock = std::chrono::steady_clock;

  void run();
  bool waitForCommand(const ros::Time& stamp);
  void exchange(int sample);
  void write() const;

  WatchedQueue queue_;  // outlives what is served on it
  ros::NodeHandle handle_;
  int samples_ = 1000;
  int warm_up_ = 100;
  double rate_ = 100.0;  // [1/s]
  bool poll_ = false;
  std::string output_;

  ros::Publisher odometry_;
  ros::Publisher pose_;
  ros::Subscriber command_subscriber_;
  ros::Subscriber status_subscriber_;
  ros::Time answered_;           // stamp of the last command
  Clock::time_point heard_;      // when it came
  std::vector<double> latency_;  // [us]
  std::vector<double> inside_;   // from the arrival of the odometry to the command's publication [us]
  std::vector<double> input_, step_, publishing_;  // of which [us]
  int missed_ = 0;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace polyfly_ros
