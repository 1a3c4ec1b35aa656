#pragma once

#include <dynamic_reconfigure/Config.h>
#include <mav_msgs/RollPitchYawrateThrust.h>
#include <online_controller/ControllerStatus.h>
#include <ros/ros.h>

#include <array>
#include <future>
#include <string>
#include <vector>

#include "online_controller_ros/controller_node.hpp"
#include "polyfly_test/soak.hpp"

namespace polyfly_ros {

/// The node as a soak flies it: in this process, over its topics and services, in lockstep with simulated time, which
/// is set here. Each odometry and, once silence is noticed, each control period is waited for until its status has
/// come. The command, published before it, has come by then.
class NodeSoak final : public polyfly_test::SoakController {
 public:
  /// `maps`: folders of multirotor_AXIS.map and aslquad_AXIS.map. Sets the node's private parameters and starts it at time zero.
  NodeSoak(std::vector<std::string> maps, const polyfly_test::SoakTuning& tuning);

  polyfly_test::SoakAnswer onOdometry(const polyfly::VehicleState& state, bool frame_fits) override;
  polyfly_test::SoakAnswer onSilence(double now, int periods) override;
  void setReference(const std::vector<polyfly::Reference>& points, double period, double start) override;
  void reconfigure(const polyfly_test::SoakTuning& tuning) override;
  void swapMaps(std::size_t set) override;
  void select(polyfly::Law law) override;

  /// Periods without a status.
  int unanswered() const noexcept { return unanswered_; }
  /// Swaps of maps that were granted.
  int swapped() const noexcept { return swapped_; }
  /// Those of the robust law's maps.
  int swappedRobust() const noexcept { return swapped_robust_; }
  /// Failures of services.
  const std::vector<std::string>& failures() const noexcept { return failures_; }

 private:
  static ros::Time toTime(double seconds);
  bool await(const ros::Time& stamp);
  polyfly_test::SoakAnswer answer(bool came);
  void finishSwap();

  ThreadQueue queue_;  // outlives what is served on it
  std::vector<std::string> maps_;
  // Limits in force.
  polyfly::MultirotorOptions in_force_;
  // Limits from the next command on.
  polyfly::MultirotorOptions offered_;
  mav_msgs::RollPitchYawrateThrust::ConstPtr command_;
  online_controller::ControllerStatus::ConstPtr status_;
  int unanswered_ = 0;
  int swapped_ = 0;
  int swapped_robust_ = 0;
  // Whether the last swap was one of the robust law's maps.
  bool swaps_robust_ = false;
  std::vector<std::string> failures_;
  std::future<std::string> swap_;

  ros::NodeHandle handle_;
  ros::Publisher odometry_;
  ros::Publisher trajectory_;
  ros::Subscriber command_subscriber_;
  ros::Subscriber status_subscriber_;
  std::unique_ptr<ControllerNode> node_;
  ros::ServiceClient reconfigure_;
  ros::ServiceClient select_;
};

}  // namespace polyfly_ros
