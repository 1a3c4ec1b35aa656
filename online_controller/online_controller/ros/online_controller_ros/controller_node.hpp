#pragma once

#include <nav_msgs/Odometry.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>

#include "online_controller/types/node_options.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller_ros/active_laws.hpp"
#include "online_controller_ros/answered.hpp"
#include "online_controller_ros/autopilot_input.hpp"
#include "online_controller_ros/callback_thread.hpp"
#include "online_controller_ros/command_output.hpp"
#include "online_controller_ros/config_thread.hpp"
#include "online_controller_ros/flight_interface.hpp"
#include "online_controller_ros/flight_reporter.hpp"
#include "online_controller_ros/flight_snapshot.hpp"
#include "online_controller_ros/law_selector.hpp"
#include "online_controller_ros/law_setup.hpp"
#include "online_controller_ros/odometry_watch.hpp"
#include "polyfly_ros/parameter_reader.hpp"

namespace polyfly_ros {

/// The controller on ROS topics: odometry and references in, attitude commands and status out. Topics and
/// parameters are listed in online_controller/README.md. It has two threads: one for control, and one for
/// configuration, which control does not wait for.
class ControllerNode {
 public:
  /// Reads the parameters, opens the maps, connects. Logs one fatal sentence and throws polyfly::Error when
  /// the parameters or a map are not fit to fly. `names` are further names under which options can be changed.
  ControllerNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                 const LegacyNames& names = {});

 private:
  struct Setup {
    LawSetup laws;
    FlightSetup flight;
    polyfly::NodeOptions node;
    OutputOptions output;
    // Where calibrated numbers come from.
    std::string provenance;

    // All but what the laws are made from.
    polyfly::MultirotorParameters parameters() const;
  };

  static Setup readSetup(const ros::NodeHandle& private_handle, bool has_legacy_names);
  ControllerNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                 const LegacyNames& names, const Setup& setup);

  void onOdometry(const nav_msgs::Odometry& message);
  void onManual(const ros::Time& now);
  void onTick();
  void onSilence();

  void record(const std_msgs::Header& header, const StageTimes& times);
  void reportCommand();
  void swapLaws();
  void heedAutopilot();
  void tellOfIdleness() const;

  // Queue of the control thread; outlives all that is served on it.
  ThreadQueue queue_;
  ros::NodeHandle handle_;
  ActiveLaws laws_;
  OdometryWatch watch_;
  polyfly::FlightSupervisor flight_;
  FlightRecord record_;
  FlightInterface interface_;
  AutopilotInput autopilot_;
  CommandOutput output_;
  FlightReporter reporter_;
  // The last command.
  Answered answered_;
  LawSelector law_selector_;
  ros::Subscriber odometry_;
  // These end first, the last one before the other.
  ConfigThread config_thread_;
  CallbackThread control_thread_;
};

}  // namespace polyfly_ros
