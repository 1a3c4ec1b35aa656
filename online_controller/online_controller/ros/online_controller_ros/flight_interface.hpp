#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/Joy.h>
#include <std_srvs/Empty.h>
#include <std_srvs/Trigger.h>
#include <trajectory_msgs/MultiDOFJointTrajectory.h>

#include <functional>
#include <string>
#include <vector>

#include "online_controller/estimation/vehicle_observer.hpp"
#include "online_controller/flight/flight_supervisor.hpp"
#include "online_controller/parameters/multirotor_parameters.hpp"
#include "online_controller_ros/flight_record.hpp"
#include "polyfly_base/time_source.hpp"

namespace polyfly_ros {

/// Sticks that a message does not have are at rest; without its mode axis or button it is off.
polyfly::RemoteControl toRemoteControl(const sensor_msgs::Joy& message, const polyfly::JoyLayout& layout);

/// References, remote control, services and the published state of a flight. Its callbacks and the
/// supervisor's other callers must not run concurrently.
class FlightInterface {
 public:
  /// Called when the sticks have made a command that is to be sent at this time.
  using OnManual = std::function<void(const ros::Time&)>;

  /// Keeps references to `flight` and `time`.
  FlightInterface(ros::NodeHandle& handle, ros::NodeHandle private_handle, polyfly::FlightSupervisor& flight,
                  const polyfly::TimeSource& time, const polyfly::MultirotorParameters& parameters,
                  OnManual on_manual);

  /// Whether an odometry bears the frame agreed; the first one may agree it.
  bool frameFits(const std::string& frame);

  /// To be called after each call of the supervisor: publishes and logs a change of the state.
  void publishChange();

  /// To be called with the answer to each odometry, when the command is out: the published observer.
  void observe(const Answered& answered);

  /// Options have changed in flight: `made` goes on from the observer's state.
  void setObserver(const polyfly::VehicleObserver& made) noexcept {
    polyfly::VehicleObserver next = made;
    next.transferState(observer_);
    observer_ = next;
  }

 private:
  void onTrajectory(const trajectory_msgs::MultiDOFJointTrajectory::ConstPtr& message);
  void onPose(const geometry_msgs::PoseStamped::ConstPtr& message);
  void onJoy(const sensor_msgs::Joy::ConstPtr& message);
  /// Serves `request`, which answers why it refuses to do that, nullptr where it does. `what` completes "refuses to".
  void serve(ros::NodeHandle& handle, const char* name, const char* what,
             std::function<const char*()> request);
  const char* resetObserver();
  const char* calibrate();
  bool onLand(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response);
  bool answer(const char* request, const char* refusal);
  template <class Message>
  void take(const Message& message, std::optional<double> start, const char* topic);
  void publish();
  void tellOfEarlyReferences();

  polyfly::FlightSupervisor& flight_;
  const polyfly::TimeSource& time_;
  polyfly::JoyLayout joy_;
  polyfly::VehicleObserver observer_;
  // Last command that was sent.
  polyfly::AttitudeCommand sent_;
  // Number of calibrations that were logged.
  unsigned calibrations_ = 0;
  // Frame of odometry and references; empty: not known yet.
  std::string frame_;
  // Frame of references that came before the first odometry.
  std::string early_frame_;
  // True when early_frame_ is the frame of the odometry.
  bool early_fits_ = true;
  // True after the outcome of the references before the first odometry was reported.
  bool told_of_early_ = false;
  // Outcome of the last reference.
  std::string reference_text_;
  unsigned published_changes_ = 0;
  OnManual on_manual_;

  ros::Publisher name_publisher_;
  ros::Publisher status_publisher_;
  ros::Publisher observer_publisher_;
  ros::Subscriber trajectory_subscriber_;
  ros::Subscriber pose_subscriber_;
  ros::Subscriber joy_subscriber_;
  std::vector<ros::ServiceServer> services_;
};

}  // namespace polyfly_ros
