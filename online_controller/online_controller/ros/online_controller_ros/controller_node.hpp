#pragma once

#include <nav_msgs/Odometry.h>
#include <online_controller/SelectLaw.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/service_server.h>
#include <ros/spinner.h>
#include <ros/steady_timer.h>
#include <ros/subscriber.h>

#include "online_controller_ros/active_laws.hpp"
#include "online_controller_ros/autopilot_input.hpp"
#include "online_controller_ros/command_output.hpp"
#include "online_controller_ros/config_thread.hpp"
#include "online_controller_ros/flight_interface.hpp"
#include "online_controller_ros/flight_record.hpp"
#include "online_controller_ros/flight_reporter.hpp"
#include "online_controller_ros/law_setup.hpp"
#include "online_controller_ros/odometry_watch.hpp"
#include "polyfly_ros/guarded_queue.hpp"
#include "polyfly_ros/parameter_reader.hpp"

namespace polyfly_ros {

/// The controller on ROS topics: odometry and references in, attitude commands and status out. Topics and
/// parameters are listed in online_controller/README.md. It has two threads: one for control, and one for
/// configuration, which control does not wait for.
class ControllerNode {
 public:
  /// Reads the parameters, opens the maps, connects. Logs one fatal sentence and throws polyfly::Error when
  /// the parameters or a map are not fit to fly. `names` are further names of options.
  ControllerNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                 const LegacyNames& names = {});

 private:
  ControllerNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                 const LegacyNames& names, const LawSetup& setup);
  void onOdometry(const nav_msgs::Odometry& message);
  void onManual(const ros::Time& now);
  void onTick();
  void onSilence();
  bool onSelectLaw(online_controller::SelectLaw::Request& request,
                   online_controller::SelectLaw::Response& response);
  void publishLaw();

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
  ros::Publisher law_publisher_;
  ros::ServiceServer law_service_;
  ros::Subscriber odometry_;
  // These end first, the last one before the other.
  ConfigThread config_thread_;
  ros::SteadyTimer timer_;
  ros::AsyncSpinner control_thread_{1, &queue_};
};

}  // namespace polyfly_ros
