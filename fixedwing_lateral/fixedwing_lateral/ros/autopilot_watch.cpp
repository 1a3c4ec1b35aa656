#include "fixedwing_lateral_ros/autopilot_watch.hpp"

#include <algorithm>
#include <sstream>

#include "polyfly_base/error.hpp"

namespace polyfly_ros {
namespace {

// Age of a state after which it says nothing any more [s].
constexpr double kTimeout = 3.0;

}  // namespace

AutopilotWatch::AutopilotWatch(const std::string& modes, const std::string& key) {
  std::istringstream list(modes);
  for (std::string mode; std::getline(list, mode, ',');) {
    mode.erase(std::remove(mode.begin(), mode.end(), ' '), mode.end());
    if (!mode.empty()) modes_.push_back(mode);
  }
  if (modes_.empty()) throw polyfly::Error(key + ": must name at least one mode, such as OFFBOARD");
}

bool AutopilotWatch::isRecent(double now) const noexcept {
  return !state_.header.stamp.isZero() && std::abs(now - state_.header.stamp.toSec()) <= kTimeout;
}

bool AutopilotWatch::isOurMode() const noexcept {
  return std::find(modes_.begin(), modes_.end(), state_.mode) != modes_.end();
}

bool AutopilotWatch::follows(double now) const noexcept {
  return isRecent(now) && state_.connected && state_.armed && isOurMode();
}

std::string AutopilotWatch::text(double now) const {
  if (!isRecent(now)) return "silent";
  if (!state_.connected) return "not connected";
  return state_.mode + (state_.armed ? ", armed" : ", not armed") + (follows(now) ? "" : ": does not follow");
}

}  // namespace polyfly_ros
