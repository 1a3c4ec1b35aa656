#include "validation_ros/validation_topics.hpp"

#include <console_bridge/console.h>
#include <std_msgs/Float64.h>

#include <algorithm>

#include "polyfly_base/error.hpp"
#include "polyfly_ros/stamps.hpp"

namespace polyfly_ros {
namespace {

// A bag has no time 0.
ros::Time timeOf(double stamp) { return std::max(ros::TIME_MIN, stampOf(stamp)); }

}  // namespace

ValidationTopics::ValidationTopics(const std::string& path) : path_(path), draft_(path) {
  try {
    bag_->open(draft_.path(), rosbag::bagmode::Write);
  } catch (const rosbag::BagException& failure) {
    abandonBag();
    fail(failure);
  }
}

ValidationTopics::~ValidationTopics() {
  try {
    closeBag();
  } catch (const rosbag::BagException&) {
    // The draft is removed.
  }
}

// The destructor of a bag tries again to close what could not be closed, and throws: such a bag is left
// alone. At the end of the program, class_loader would warn that the bag's plug-in is still in use.
void ValidationTopics::abandonBag() {
  bag_.release();
  console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
}

void ValidationTopics::closeBag() {
  if (!bag_) return;
  try {
    bag_->close();
  } catch (const rosbag::BagException&) {
    abandonBag();
    throw;
  }
  bag_.reset();
}

void ValidationTopics::fail(const rosbag::BagException& failure) const {
  throw polyfly::Error(path_ + ": cannot be written: " + failure.what());
}

void ValidationTopics::number(const std::string& topic, double stamp, double value) {
  std_msgs::Float64 message;
  message.data = value;
  bag_->write("/validation/" + topic, timeOf(stamp), message);
}

void ValidationTopics::write(const std::vector<polyfly::ReplaySample>& samples,
                             const polyfly::ValidationReport& report) try {
  for (std::size_t axis = 0; axis < report.axes.size(); ++axis) writeAxis(samples, report.axes[axis], axis);
  for (const polyfly::ReplaySample& sample : samples) {
    if (!sample.has_reference) continue;
    number("tracking_error", sample.state.stamp, (sample.state.position - sample.reference.position).norm());
  }
} catch (const rosbag::BagException& failure) {
  fail(failure);
}

void ValidationTopics::writeAxis(const std::vector<polyfly::ReplaySample>& samples,
                                 const polyfly::AxisValidation& axis, std::size_t index) {
  for (const polyfly::ReplaySample& sample : samples) {
    if (!sample.has_reference) continue;
    const polyfly::AxisReport& report = sample.report.axis[index];
    const bool inside = report.lookup == polyfly::LookupStatus::kInside;
    number(axis.axis + "/inside", sample.state.stamp, inside ? 1.0 : 0.0);
    number(axis.axis + "/region", sample.state.stamp, inside ? static_cast<double>(report.region) : -1.0);
  }
  for (const auto& [stamp, face, edge] : axis.edge_series) {
    number(axis.axis + "/face_distance", stamp, face);
    number(axis.axis + "/edge_distance", stamp, edge);
  }
  for (const auto& [stamp, difference] : axis.qp_series)
    number(axis.axis + "/qp_difference", stamp, difference);
}

void ValidationTopics::close() {
  try {
    closeBag();
  } catch (const rosbag::BagException& failure) {
    fail(failure);
  }
  draft_.commit();
}

}  // namespace polyfly_ros
