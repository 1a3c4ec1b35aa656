#pragma once

#include <nav_msgs/Odometry.h>
#include <online_controller/SelectLaw.h>
#include <ros/ros.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "online_controller/options.hpp"
#include "online_controller/poll_window.hpp"
#include "online_controller_ros/background.hpp"
#include "online_controller_ros/callback_thread.hpp"
#include "online_controller_ros/command_output.hpp"
#include "online_controller_ros/flight_interface.hpp"
#include "online_controller_ros/flight_snapshot.hpp"
#include "online_controller_ros/law_keeper.hpp"
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
/// commands and status out. Topics and parameters are listed in online_controller/README.md. It has two
/// threads of its own: one for control, and one for all that control must not wait for.
class ExplicitMpcNode {
 public:
  /// Reads the parameters, opens the maps, connects. Logs one fatal sentence and throws polyfly::Error when
  /// the parameters or a map are not fit to fly. `names`: under which options can be changed besides ours.
  ExplicitMpcNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                  const ForeignNames& names = {});

 private:
  struct Setup {
    LawSetup laws;
    FlightSetup flight;
    NodeOptions node;
    OutputOptions output;
    RealTimeOptions real_time;
  };

  static Setup readSetup(const ros::NodeHandle& private_handle);
  ExplicitMpcNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                  const ForeignNames& names, const Setup& setup);
  void connect();

  void onOdometry(const nav_msgs::Odometry::ConstPtr& message);
  void onManual(const ros::Time& now);
  void onWatchdog();
  bool onSelectLaw(online_controller::SelectLaw::Request& request,
                   online_controller::SelectLaw::Response& response);
  void publishLaw();

  void finish(const polyfly::ControlReport& report, const std_msgs::Header& header, const StageTimes& times);
  void publishStatus(const polyfly::ControlReport& report, const std_msgs::Header& header,
                     const StageTimes& times);
  void leaveSnapshot(const polyfly::ControlReport& report, const std_msgs::Header& header,
                     const StageTimes& times);
  void exchangeLaws();
  void countLost(const ros::Time& stamp);
  std::int64_t lookupTime(const polyfly::ControlReport& report);
  void logChange(const polyfly::ControlReport& report);
  polyfly::LawSwitch& laws() { return keeper_.flight(); }

  WatchedQueue queue_;  // of the control thread; outlives all that is served on it
  ros::NodeHandle handle_;
  LawKeeper keeper_;
  polyfly::FlightSupervisor flight_;
  FlightInterface interface_;
  CommandOutput output_;
  FlightRecord record_;
  double control_period_;  // [s]
  polyfly::PollWindow poll_;
  ros::Duration silence_;  // longer than this without odometry is silence

  ros::Publisher status_publisher_;
  ros::Publisher law_publisher_;
  ros::ServiceServer law_service_;
  ros::Subscriber odometry_subscriber_;
  ros::Timer watchdog_;

  bool has_odometry_ = false;
  ros::Time arrival_;              // of the last odometry
  std::string frame_;              // of the last odometry
  double odometry_age_ = 0.0;      // at its arrival [s]
  ros::Time last_stamp_;           // of the last odometry
  std::int64_t last_prepare_ = 0;  // what the sample before took after its command was out [ns]
  std::uint32_t sequence_ = 0;
  polyfly::ControlStatus logged_status_ = polyfly::ControlStatus::kOptimal;
  polyfly::ControlReason logged_reason_ = polyfly::ControlReason::kNone;

  // These end first.
  std::optional<Background> background_;
  std::optional<CallbackThread> control_thread_;
};

}  // namespace polyfly_ros
