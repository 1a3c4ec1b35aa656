#include "validation_ros/validation_topics.hpp"

#include <console_bridge/console.h>
#include <rosbag/bag.h>
#include <std_msgs/Float64.h>

#include <algorithm>
#include <memory>

#include "polyfly_base/error.hpp"
#include "polyfly_base/file_draft.hpp"
#include "polyfly_ros/stamps.hpp"

namespace polyfly_ros {
namespace {

void write(const std::string& topic, double stamp, double value, rosbag::Bag* bag) {
  std_msgs::Float64 message;
  message.data = value;
  // A bag has no time 0.
  bag->write("/validation/" + topic, std::max(ros::TIME_MIN, stampOf(stamp)), message);
}

void writeAxis(const ValidatedFlight& flight, std::size_t index, rosbag::Bag* bag) {
  const polyfly::AxisValidation& axis = flight.report.axes[index];
  for (const polyfly::ReplaySample& sample : flight.samples) {
    if (!sample.has_reference) continue;
    const polyfly::AxisReport& report = sample.report.axis[index];
    const bool inside = report.lookup == polyfly::LookupStatus::kInside;
    write(axis.axis + "/inside", sample.state.stamp, inside ? 1.0 : 0.0, bag);
    write(axis.axis + "/region", sample.state.stamp, inside ? static_cast<double>(report.region) : -1.0, bag);
  }
  for (const auto& [stamp, face, edge] : axis.edge_series) {
    write(axis.axis + "/face_distance", stamp, face, bag);
    write(axis.axis + "/edge_distance", stamp, edge, bag);
  }
  for (const auto& [stamp, difference] : axis.qp_series)
    write(axis.axis + "/qp_difference", stamp, difference, bag);
}

void writeFlight(const ValidatedFlight& flight, rosbag::Bag* bag) {
  for (std::size_t axis = 0; axis < flight.report.axes.size(); ++axis) writeAxis(flight, axis, bag);
  for (const polyfly::ReplaySample& sample : flight.samples) {
    if (!sample.has_reference) continue;
    const double error = (sample.state.position - sample.reference.position).norm();
    write("tracking_error", sample.state.stamp, error, bag);
  }
}

}  // namespace

void writeValidationTopics(const std::vector<ValidatedFlight>& flights, const std::string& path) {
  polyfly::FileDraft draft(path);
  auto bag = std::make_unique<rosbag::Bag>();
  try {
    bag->open(draft.path(), rosbag::bagmode::Write);
    for (const ValidatedFlight& flight : flights) writeFlight(flight, bag.get());
    bag->close();
  } catch (const rosbag::BagException& failure) {
    // The destructor of a bag tries again to close what could not be closed, and throws: such a bag is left alone. At the
    // end of the program, class_loader would warn that the bag's plug-in is still in use.
    bag.release();
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
    throw polyfly::Error(path + ": cannot be written: " + failure.what());
  }
  draft.commit();
}

}  // namespace polyfly_ros
