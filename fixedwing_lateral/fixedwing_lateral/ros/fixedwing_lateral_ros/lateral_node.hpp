#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <fixedwing_lateral/Mission.h>
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <mavros_msgs/State.h>
#include <mavros_msgs/VFR_HUD.h>
#include <nav_msgs/Odometry.h>
#include <ros/ros.h>
#include <sensor_msgs/Imu.h>
#include <std_msgs/Bool.h>

#include <chrono>
#include <cstdint>
#include <string>

#include "fixedwing_lateral/guidance.hpp"
#include "fixedwing_lateral/lateral_parameters.hpp"
#include "fixedwing_lateral_ros/autopilot_watch.hpp"
#include "fixedwing_lateral_ros/conversions.hpp"
#include "polyfly_base/change_bounds.hpp"
#include "polyfly_base/time_source.hpp"
#include "polyfly_ros/guarded_queue.hpp"
#include "polyfly_ros/option_table.hpp"
#include "polyfly_ros/parameters_in_force.hpp"
#include "polyfly_ros/reconfigure_server.hpp"

namespace polyfly_ros {

/// The lateral guidance on ROS topics. Topics and parameters are listed in fixedwing_lateral/README.md.
/// Callbacks must not run concurrently: the nodelet uses the single-threaded queue of its manager.
class LateralNode {
 public:
  /// Reads the parameters and connects. Logs one fatal sentence and throws polyfly::Error where one is not
  /// fit.
  LateralNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle);

 private:
  using Setup = polyfly::LateralParameters;

  static Setup readSetup(const ros::NodeHandle& private_handle);
  LateralNode(ros::NodeHandle handle, ros::NodeHandle private_handle, const Setup& setup);
  void connect(ros::NodeHandle& handle);

  void onOdometry(const nav_msgs::Odometry::ConstPtr& message);
  void onImu(const sensor_msgs::Imu::ConstPtr& message);
  void onHud(const mavros_msgs::VFR_HUD::ConstPtr& message);
  void onWind(const geometry_msgs::TwistWithCovarianceStamped::ConstPtr& message);
  void onMission(const fixedwing_lateral::Mission::ConstPtr& message);
  void onAutopilot(const mavros_msgs::State::ConstPtr& message);
  void onEngaged(const std_msgs::Bool::ConstPtr& message);
  void onTimer();
  void onReconfigure();
  void writeInForce(polyfly::OptionsText& text) const;
  void requireFrame(const std::string& frame) const;
  void checkEarlyMission();
  void tellOfClock();

  /// At the time `now` [s].
  void step(double now);
  void publishCommand(const polyfly::GuidanceOutput& output, const std_msgs::Header& header);
  void publishStatus(const polyfly::GuidanceOutput& output, const std_msgs::Header& header);
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& status);
  void logChange(const polyfly::GuidanceOutput& output);

  GuardedQueue queue_;
  Setup setup_;
  // Options of setup_ that may change in flight.
  OptionTable table_;
  // Bounds on changes of the table's values.
  polyfly::ChangeBounds bounds_;
  ReconfigureServer reconfigure_;
  polyfly::LateralGuidance guidance_;
  ParametersInForce in_force_;
  ros::Publisher twist_publisher_, attitude_publisher_, status_publisher_, marker_publisher_;
  ros::Subscriber odometry_subscriber_, imu_subscriber_, hud_subscriber_, wind_subscriber_,
      mission_subscriber_, engaged_subscriber_, autopilot_subscriber_;
  ros::Timer timer_;
  // Wall-clock timer for simulated time, which may stand still.
  ros::SteadyTimer wall_timer_;
  diagnostic_updater::Updater diagnostics_;

  polyfly::GuidanceInput input_;
  AutopilotWatch autopilot_;
  // Last value received on the topic `engaged`.
  bool engaged_ = true;
  std_msgs::Header odometry_header_;
  double altitude_ = 0.0;
  double imu_rate_ = 0.0;
  ros::Time imu_stamp_;
  // Time at which the next step is due [s].
  double next_ = 0.0;
  polyfly::TimeSource time_;
  // Frame of the mission in force; empty: the frame of the odometry.
  std::string mission_frame_;
  bool has_odometry_ = false;
  // True after the first command was sent.
  bool commands_ = false;
  bool told_of_wall_time_ = false;
  double feedback_time_ = 0.0;
  double preparation_time_ = 0.0;
  std::uint64_t steps_ = 0;
  std::uint64_t late_steps_ = 0;
  // Last output, for the log and the diagnostics.
  polyfly::GuidanceOutput shown_;
};

}  // namespace polyfly_ros
