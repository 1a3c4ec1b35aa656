#pragma once

#include <mav_msgs/RollPitchYawrateThrust.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/String.h>
#include <trajectory_msgs/MultiDOFJointTrajectory.h>

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "polyfly_test/multirotor_plant.hpp"
#include "polyfly_test/odometry_fault.hpp"

namespace polyfly_ros {

/// The simulated vehicle. It owns the time of the flight: it publishes /clock and odometry. In lockstep it waits for
/// the command that bears the odometry's stamp before time goes on. It also waits until the controller's statuses are
/// no more than a few samples behind. Topics and parameters: test/README.md.
class PlantNode {
 public:
  /// Throws polyfly::Error when a parameter breaks its rule.
  PlantNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);
  ~PlantNode();
  PlantNode(const PlantNode&) = delete;
  PlantNode& operator=(const PlantNode&) = delete;

 private:
  struct Settings {
    polyfly::PlantOptions plant;
    polyfly::FaultOptions faults;
    // Simulated duration [s]. 0: until the end of the trajectory.
    double duration = 0.0;
    // Simulated time per wall time. 0: as fast as possible.
    double real_time_factor = 0.0;
    // Simulated time per wall time while odometry is silent.
    double silence_real_time_factor = 1.0;
    // Wall time that one command may take [s]: long, since a machine may stand still meanwhile.
    double command_timeout = 30.0;
    // Wall time until all are connected [s].
    double start_timeout = 60.0;
    // Wall time from connected to start [s].
    double settle_time = 0.3;
    // Wall time for the recorder to close its file [s].
    double end_timeout = 10.0;
    // Number of odometry subscribers that the start needs.
    int odometry_subscribers = 1;
    // Samples that the statuses may be behind. 0: there is no Polyfly controller, whose statuses could be subscribed.
    int status_lag = 0;
    // Whether to wait for recorder/ready and recorder/closed.
    bool recorder = false;
    std::string frame = "world";
    std::string body_frame = "base_link";
  };

  void readSettings(const ros::NodeHandle& private_nh);
  void connect();
  void run();
  bool waitForStart();
  std::string missingForStart();
  void fly();
  void publishClock(const ros::Time& now);
  void publishSample(polyfly::MultirotorPlant& plant, double time);
  void waitForAnswer(const ros::Time& stamp);
  void publishSummary(const polyfly::MultirotorPlant& plant, long samples);
  void finish();
  void pause(double seconds);

  ros::NodeHandle nh_;
  Settings settings_;
  ros::Publisher clock_pub_;
  ros::Publisher odometry_pub_;
  ros::Publisher truth_pub_;
  ros::Publisher disturbance_pub_;
  ros::Publisher summary_pub_;

  std::mutex mutex_;  // guards what the callbacks write
  std::condition_variable changed_;
  trajectory_msgs::MultiDOFJointTrajectory::ConstPtr trajectory_;
  polyfly::AttitudeCommand command_;
  ros::Time command_stamp_;
  bool has_command_ = false;
  std::deque<ros::Time> untold_;  // stamps of odometry whose status has not come
  bool controller_has_reference_ = false;
  bool recorder_ready_ = false;
  bool recorder_closed_ = false;
  bool stopping_ = false;

  // These end before what their callbacks write.
  ros::Subscriber command_sub_;
  ros::Subscriber status_sub_;
  ros::Subscriber flight_status_sub_;
  ros::Subscriber trajectory_sub_;
  ros::Subscriber ready_sub_;
  ros::Subscriber closed_sub_;

  // Simulated start of the flight.
  ros::Time start_;
  long missed_commands_ = 0;
  std::thread thread_;
};

}  // namespace polyfly_ros
