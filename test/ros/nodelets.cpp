#include <pluginlib/class_list_macros.hpp>

#include "figure_player.hpp"
#include "flight_recorder.hpp"
#include "latency_probe.hpp"
#include "plant_node.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_ros/node_shell.hpp"

namespace polyfly_test {

/// A bad parameter ends the manager, as it ends the stand-alone node.
template <class Node>
class Shell : public polyfly_ros::NodeShell<Node> {
  void onInit() override {
    try {
      polyfly_ros::NodeShell<Node>::onInit();
    } catch (const polyfly::Error& error) {
      ROS_FATAL_STREAM(error.what());
      ros::requestShutdown();
    }
  }
};

class MultirotorPlant : public Shell<polyfly_ros::PlantNode> {};
class FigurePlayer : public Shell<polyfly_ros::FigurePlayer> {};
class FlightRecorder : public Shell<polyfly_ros::FlightRecorder> {};
class LatencyProbe : public Shell<polyfly_ros::LatencyProbe> {};

}  // namespace polyfly_test

PLUGINLIB_EXPORT_CLASS(polyfly_test::MultirotorPlant, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(polyfly_test::FigurePlayer, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(polyfly_test::FlightRecorder, nodelet::Nodelet)
PLUGINLIB_EXPORT_CLASS(polyfly_test::LatencyProbe, nodelet::Nodelet)
