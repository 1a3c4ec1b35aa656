#include "polyfly_ros/parameters_in_force.hpp"

#include <std_msgs/String.h>

#include <utility>

#include "polyfly_base/version.hpp"

namespace polyfly_ros {
namespace {

constexpr const char* kName = "parameters_in_force";
constexpr bool kLatchedText = true;

}  // namespace

ParametersInForce::ParametersInForce(const ros::NodeHandle& private_handle, std::string vehicle, Write write,
                                     Settled settled)
    : node_(private_handle.getNamespace()),
      vehicle_(std::move(vehicle)),
      write_(std::move(write)),
      settled_(std::move(settled)) {
  ros::NodeHandle handle(private_handle);
  publisher_ = handle.advertise<std_msgs::String>(kName, 1, kLatchedText);
  publish();
}

void ParametersInForce::hasChanged(const std::string& cause) {
  if (causes_.find(cause) == std::string::npos) causes_ += (causes_.empty() ? "" : ", ") + cause;
}

void ParametersInForce::publish() {
  if (causes_.empty() || !settled_()) return;
  const std::string space = polyfly::kInForceGroup;
  polyfly::OptionsText text;
  text.text(space + "/node", node_);
  text.text(space + "/version", polyfly::kVersion);
  text.text(space + "/vehicle", vehicle_);
  text.text(space + "/change", causes_);
  write_(text);
  causes_.clear();
  std_msgs::String message;
  message.data = text.yaml();
  publisher_.publish(message);
}

}  // namespace polyfly_ros
