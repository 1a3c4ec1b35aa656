#pragma once

#include <nav_msgs/Odometry.h>
#include <online_controller/SelectLaw.h>
#include <ros/ros.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "online_controller/options.hpp"
#include "online_controller_ros/flight_interface.hpp"
#include "online_controller_ros/law_setup.hpp"
#include "online_controller_ros/parameter_reader.hpp"

namespace polyfly_ros {

/// What the node needs beyond the controller's own options.
struct NodeOptions {
  int stale_periods = 10;  ///< control periods without odometry after which it counts as silent
};

template <class Options, class Visit>
void visitNodeOptions(Options& options, Visit&& visit) {
  visit("controller/stale_periods", options.stale_periods, "control periods", polyfly::Range{2.0, 10000.0});
}

/// The controller on ROS topics, explicit unless another law is chosen: odometry and references in, attitude
/// commands and status out. Topics and parameters are listed in online_controller/README.md. Callbacks must
/// not run concurrently.
class ExplicitMpcNode {
 public:
  /// Reads the parameters, opens the maps, connects. Logs one fatal sentence and throws polyfly::Error when
  /// the parameters or a map are not fit to fly.
  ExplicitMpcNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle);

 private:
  struct Setup {
    LawSetup laws;
    FlightSetup flight;
    NodeOptions node;
  };

  static Setup readSetup(const ros::NodeHandle& private_handle);
  ExplicitMpcNode(ros::NodeHandle handle, const Setup& setup);
  void connect(ros::NodeHandle& handle);

  void onOdometry(const nav_msgs::Odometry::ConstPtr& message);
  void onManual(const ros::Time& now);
  void onWatchdog();
  bool onSelectLaw(online_controller::SelectLaw::Request& request,
                   online_controller::SelectLaw::Response& response);
  void publishLaw();

  void publish(const polyfly::ControlReport& report, const std_msgs::Header& header,
               std::int64_t step_time_ns);
  std::int64_t lookupTime(const polyfly::ControlReport& report) const;
  void logChange(const polyfly::ControlReport& report);

  Laws laws_;
  polyfly::LawSwitch& controller_;
  polyfly::FlightSupervisor flight_;
  FlightInterface interface_;
  double control_period_;  // [s]
  ros::Duration silence_;  // longer than this without odometry is silence

  ros::Publisher command_publisher_;
  ros::Publisher status_publisher_;
  ros::Publisher law_publisher_;
  ros::ServiceServer law_service_;
  ros::Subscriber odometry_subscriber_;
  ros::Timer watchdog_;

  bool has_odometry_ = false;
  ros::Time arrival_;          // of the last odometry
  std::string frame_;          // of the last odometry
  double odometry_age_ = 0.0;  // at its arrival [s]
  std::uint32_t sequence_ = 0;
  polyfly::ControlStatus logged_status_ = polyfly::ControlStatus::kOptimal;
  polyfly::ControlReason logged_reason_ = polyfly::ControlReason::kNone;
};

}  // namespace polyfly_ros
