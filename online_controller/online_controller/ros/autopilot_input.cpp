#include "online_controller_ros/autopilot_input.hpp"

#include <cmath>

namespace polyfly_ros {
namespace {

using polyfly::AutopilotReport;

constexpr double kOldest = 2.0;  // age of a message that counts [s]

// On its way up or down by itself a vehicle is neither here nor there.
AutopilotReport::Place placeOf(const mavros_msgs::ExtendedState& message) noexcept {
  using mavros_msgs::ExtendedState;
  if (message.landed_state == ExtendedState::LANDED_STATE_ON_GROUND) return AutopilotReport::Place::kOnGround;
  if (message.landed_state == ExtendedState::LANDED_STATE_IN_AIR) return AutopilotReport::Place::kInAir;
  return AutopilotReport::Place::kUnknown;
}

}  // namespace

AutopilotInput::AutopilotInput(ros::NodeHandle& handle)
    : state_subscriber_(handle.subscribe<mavros_msgs::State>(
          "mavros/state", 1, [this](const mavros_msgs::State::ConstPtr& message) { state_ = *message; })),
      extended_subscriber_(handle.subscribe<mavros_msgs::ExtendedState>(
          "mavros/extended_state", 1,
          [this](const mavros_msgs::ExtendedState::ConstPtr& message) { extended_ = *message; })) {}

AutopilotReport AutopilotInput::report(double now) const noexcept {
  const auto is_recent = [now](const ros::Time& stamp) { return std::abs(now - stamp.toSec()) <= kOldest; };
  AutopilotReport report;
  report.fresh = state_.connected != 0 && is_recent(state_.header.stamp) && is_recent(extended_.header.stamp);
  report.armed = state_.armed != 0;
  report.guided = state_.guided != 0;
  report.place = placeOf(extended_);
  return report;
}

}  // namespace polyfly_ros
