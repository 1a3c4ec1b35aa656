#pragma once

#include <online_controller/ControllerStatus.h>
#include <ros/ros.h>

#include <array>
#include <memory>

#include "polyfly_ros/guarded_queue.hpp"
#include "region_maps/region_map.hpp"
#include "validation/map_use.hpp"

namespace polyfly_ros {

/// Keeps the coverage of the three maps while flying, from the controller's own account.
///
/// In: controller_status (online_controller/ControllerStatus). Out, once each `period` of wall time: coverage
/// (diagnostic_msgs/DiagnosticArray), one status per axis. It has samples, share inside, regions visited, least
/// distance to the map's edge and its parameter, and parameters that left their range. OK: inside all the time; WARN:
/// was outside since the start; ERROR: the maps are not those that fly.
///
/// Private parameters: maps/longitudinal, maps/lateral, maps/vertical (paths, as the controller has them),
/// period [s].
class CoverageNode {
 public:
  /// Throws polyfly::Error naming the parameter or the map.
  CoverageNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle);
  CoverageNode(const CoverageNode&) = delete;
  CoverageNode& operator=(const CoverageNode&) = delete;

 private:
  void onStatus(const online_controller::ControllerStatus::ConstPtr& message);
  void count(std::size_t axis, double stamp, const online_controller::AxisStatus& status);
  void publish() const;

  GuardedQueue queue_;
  std::array<std::unique_ptr<polyfly::RegionMap>, 3> maps_;
  std::array<std::unique_ptr<polyfly::MapUseCounter>, 3> counters_;
  std::array<std::size_t, 3> foreign_{};  // samples with another number of parameters
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
  ros::WallTimer timer_;
};

}  // namespace polyfly_ros
