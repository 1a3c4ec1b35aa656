#include "validation_ros/coverage_node.hpp"

#include <diagnostic_msgs/DiagnosticArray.h>

#include <exception>
#include <limits>
#include <vector>

#include "online_controller/laws/axis.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_ros/parameter_reader.hpp"
#include "region_maps/region_map.hpp"
#include "validation/replay.hpp"

namespace polyfly_ros {
namespace {

using diagnostic_msgs::DiagnosticStatus;

constexpr std::uint32_t kQueue = 1000;  // a flight in simulated time is faster than its coverage for a while

std::string text(double value) {
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

void add(const std::string& key, const std::string& value, DiagnosticStatus* status) {
  diagnostic_msgs::KeyValue pair;
  pair.key = key;
  pair.value = value;
  status->values.push_back(pair);
}

DiagnosticStatus statusOf(const polyfly::MapUse& use, const polyfly::RegionMap& map, const char* axis,
                          std::size_t foreign) {
  DiagnosticStatus status;
  status.name = std::string("coverage: ") + axis;
  status.hardware_id = std::string(map.name());
  status.level = DiagnosticStatus::OK;
  status.message = use.samples == 0 ? "no sample yet" : "inside the map";
  if (use.inside < use.samples) {
    status.level = DiagnosticStatus::WARN;
    status.message = std::to_string(use.samples - use.inside) + " samples outside the map";
  }
  if (foreign > 0) {
    status.level = DiagnosticStatus::ERROR;
    status.message = "the controller has other parameters: it flies another map";
    add("foreign_samples", std::to_string(foreign), &status);
  }
  add("samples", std::to_string(use.samples), &status);
  add("share_inside", text(use.share()), &status);
  add("regions_visited", std::to_string(use.visited()), &status);
  add("regions", std::to_string(use.regions()), &status);
  add("edge_distance_least", text(use.edge.least), &status);
  if (use.edge_parameter >= 0) {
    add("edge_parameter", use.parameters[static_cast<std::size_t>(use.edge_parameter)].name, &status);
  }
  for (const polyfly::ParameterUse& parameter : use.parameters) {
    if (parameter.outside > 0) add(parameter.name + "_outside", std::to_string(parameter.outside), &status);
  }
  return status;
}

}  // namespace

CoverageNode::CoverageNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle) try
    : queue_(handle) {
  ParameterReader reader(private_handle);
  for (std::size_t axis = 0; axis < maps_.size(); ++axis) {
    const std::string key = std::string("maps/") + polyfly::kAxisNames[axis].axis;
    maps_[axis] = std::make_unique<polyfly::RegionMap>(polyfly::RegionMap::open(
        reader.requiredText(key, "the path of a region map"), polyfly::kGreatestFlownMap));
    if (polyfly::axisOf(*maps_[axis]) != axis) {
      throw polyfly::Error("parameter " + private_handle.resolveName(key) + ": " + maps_[axis]->path() +
                           " serves another axis");
    }
    counters_[axis] = std::make_unique<polyfly::MapUseCounter>(*maps_[axis]);
  }
  double period = 1.0;
  reader("period", period, "s", polyfly::Range{0.01, 3600.0});
  reader.refuseRemoved({{"summary", "validate_bag writes the coverage of a recorded flight as JSON"}});
  reader.refuseUnknown({"maps"});
  ros::NodeHandle nh = onQueue(handle, queue_);
  publisher_ = nh.advertise<diagnostic_msgs::DiagnosticArray>("coverage", 10);
  subscriber_ = nh.subscribe("controller_status", kQueue, &CoverageNode::onStatus, this,
                             ros::TransportHints().tcpNoDelay());
  timer_ = nh.createWallTimer(ros::WallDuration(period), [this](const ros::WallTimerEvent&) { publish(); });
} catch (const std::exception& error) {
  ROS_FATAL("coverage does not start: %s", error.what());
  throw;
}

void CoverageNode::onStatus(const online_controller::ControllerStatus::ConstPtr& message) {
  using online_controller::ControllerStatus;
  const bool tracked =
      message->status != ControllerStatus::NO_REFERENCE && message->reason != ControllerStatus::REASON_STALE;
  if (!tracked) return;
  const double stamp = message->header.stamp.toSec();
  count(0, stamp, message->longitudinal);
  count(1, stamp, message->lateral);
  count(2, stamp, message->vertical);
}

// Without parameters the odometry or the reference was not finite.
void CoverageNode::count(std::size_t axis, double stamp, const online_controller::AxisStatus& status) {
  const std::size_t size = maps_[axis]->parameters().size();
  if (status.theta.size() == size) {
    counters_[axis]->add(stamp, status.theta.data());
  } else if (status.theta.empty()) {
    const std::vector<double> nothing(size, std::numeric_limits<double>::quiet_NaN());
    counters_[axis]->add(stamp, nothing.data());
  } else {
    ++foreign_[axis];
  }
}

void CoverageNode::publish() const {
  diagnostic_msgs::DiagnosticArray message;
  message.header.stamp = ros::Time::now();
  for (std::size_t axis = 0; axis < maps_.size(); ++axis) {
    message.status.push_back(
        statusOf(counters_[axis]->use(), *maps_[axis], polyfly::kAxisNames[axis].axis, foreign_[axis]));
  }
  publisher_.publish(message);
}

}  // namespace polyfly_ros
